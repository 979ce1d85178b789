#include "formats/geometry_rules.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "formats/byte_io.h"
#include "formats/checked_math.h"
#include "formats/header_rules.h"

namespace spool::format {

namespace {

using enum FailureClass;

bool is_lower(char c) {
  return c >= 'a' && c <= 'z';
}
bool is_upper(char c) {
  return c >= 'A' && c <= 'Z';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_channel_name(std::string_view name) {
  if (name.size() < 3 || name.size() > kMaxNameBytes) return false;
  const size_t dot = name.find('.');
  if (dot == std::string_view::npos || dot == 0 || dot + 1 == name.size()) return false;
  const std::string_view layer = name.substr(0, dot);
  const std::string_view component = name.substr(dot + 1);
  return is_lower(layer[0]) &&
         std::ranges::all_of(layer,
                             [](char c) { return is_lower(c) || is_digit(c) || c == '_'; }) &&
         (is_lower(component[0]) || is_upper(component[0])) &&
         std::ranges::all_of(component,
                             [](char c) { return is_lower(c) || is_upper(c) || is_digit(c); });
}

Judged<void> check_range(const char* field, uint64_t value, uint64_t low, uint64_t high) {
  if (value >= low && value <= high) return {};
  return violates(kInvalid, "{} is {}, outside {}..{}", field, value, low, high);
}

Judged<void> check_image(const DumpHeader& header) {
  SPOOL_JUDGE(check_range("width", header.width, 1, kMaxSide));
  SPOOL_JUDGE(check_range("height", header.height, 1, kMaxSide));
  SPOOL_JUDGE(check_range("width * height", uint64_t{header.width} * header.height, 1, kMaxPixels));
  SPOOL_JUDGE(check_range("tile_size", header.tile_size, kMinTileSize, kMaxTileSize));
  if (!std::has_single_bit(header.tile_size)) {
    return violates(kInvalid, "tile_size {} is not a power of two", header.tile_size);
  }
  SPOOL_JUDGE(check_range("spp", header.spp, 1, kMaxSpp));
  SPOOL_JUDGE(check_range("block_spp", header.block_spp, 1, kMaxBlockSpp));
  SPOOL_JUDGE(check_range("pixel_filter", static_cast<uint32_t>(header.pixel_filter), 0, 0));
  SPOOL_JUDGE(check_range("colour_space", static_cast<uint32_t>(header.colour_space), 0, 0));
  return check_range("sample_order", static_cast<uint32_t>(header.sample_order), 0, 1);
}

Judged<void> check_channel(const ChannelInfo& channel, size_t c) {
  if (!is_channel_name(channel.name)) {
    return violates(kInvalid, "name of channel {} is not `layer.component`", c);
  }
  SPOOL_JUDGE(check_range("dtype", static_cast<uint16_t>(channel.type), 1, 3));
  SPOOL_JUDGE(check_range("semantic", channel.semantic, 0, static_cast<uint16_t>(Semantic::kBits)));
  return check_range("scope", static_cast<uint16_t>(channel.scope), 0, 2);
}

Judged<void> check_neighbours(const std::vector<ChannelInfo>& channels, size_t c) {
  const ChannelInfo& channel = channels[c];
  const uint32_t previous_group = c == 0 ? 0 : channels[c - 1].group;
  const bool same_group = channel.group == previous_group;
  if (!same_group && (c == 0 || channel.group != previous_group + 1)) {
    return violates(kInvalid, "group {} of channel {} does not follow group {}", channel.group,
                    channel.name, previous_group);
  }
  for (size_t earlier = 0; earlier < c; ++earlier) {
    if (channels[earlier].name == channel.name) {
      return violates(kInvalid, "channel {} occurs twice", channel.name);
    }
    const bool same_layer = layer_of(channels[earlier].name) == layer_of(channel.name);
    const bool joined = same_group && layer_of(channels[c - 1].name) == layer_of(channel.name);
    if (same_layer && !joined) {
      return violates(kInvalid, "layer of channel {} is not one run of one group", channel.name);
    }
  }
  if (c > 0 && same_group &&
      (channels[c - 1].type != channel.type || channels[c - 1].scope != channel.scope)) {
    return violates(kInvalid, "channel {} differs in dtype or scope from its group", channel.name);
  }
  return {};
}

Judged<void> check_radiance(const std::vector<ChannelInfo>& channels) {
  constexpr std::array<std::string_view, 3> kNames = {"radiance.R", "radiance.G", "radiance.B"};
  for (size_t c = 0; c < kNames.size(); ++c) {
    if (channels[c].name != kNames[c] || channels[c].group != 0) {
      return violates(kInvalid, "group 0 is not radiance.R, radiance.G, radiance.B");
    }
  }
  if (channels.size() > 3 && channels[3].group == 0) {
    return violates(kInvalid, "group 0 has more than the three radiance channels");
  }
  if (channels[0].type == DataType::kUint32 || channels[0].scope != Scope::kSample) {
    return violates(kInvalid, "radiance is not f16 or f32 of scope sample");
  }
  return {};
}

// Sizes that the limits of the fields alone do not bound.
Judged<void> check_volume(const DumpHeader& header) {
  const uint64_t columns = std::min(header.width, header.tile_size);
  const uint64_t rows = std::min(header.height, header.tile_size);
  const uint64_t samples = std::min(header.spp, header.block_spp);
  const uint64_t tiles = *checked_product(
      {divide_up(header.width, header.tile_size), divide_up(header.height, header.tile_size)});
  const uint64_t blocks = divide_up(header.spp, header.block_spp);
  uint64_t slots = 0;
  for (size_t c = 0; c < header.channels.size();) {
    const ChannelInfo& first = header.channels[c];
    size_t end = c;
    while (end < header.channels.size() && header.channels[end].group == first.group)
      ++end;
    const bool pass = first.scope == Scope::kPass;
    const bool pixel = first.scope == Scope::kPixel;
    const auto bytes = checked_product({end - c, pass ? 1 : rows, pass ? 1 : columns,
                                        pixel ? 1 : samples, bytes_per_value(first.type)});
    if (!bytes || *bytes > kMaxRawBytes) {
      return violates(kInvalid, "a block of group {} is larger than {} bytes", first.group,
                      kMaxRawBytes);
    }
    slots += *checked_product({pass ? 1 : tiles, pixel ? 1 : blocks});
    c = end;
  }
  if (slots > kMaxBlocks) {
    return violates(kInvalid, "{} blocks, the limit is {}: larger tiles or blocks are needed",
                    slots, kMaxBlocks);
  }
  return {};
}

Judged<ChannelInfo> parse_channel(std::span<const std::byte> entry, size_t c, uint16_t minor) {
  const auto field = entry.first(kMaxNameBytes + 1);
  const auto* text = reinterpret_cast<const char*>(field.data());
  const size_t length = ::strnlen(text, field.size());
  if (length > kMaxNameBytes || !all_zero(field.subspan(length))) {
    return violates(kInvalid, "name of channel {} is not padded with NUL", c);
  }
  if (minor <= kMinorVersion && !all_zero(entry.subspan(chan::kReserved))) {
    return violates(kInvalid, "reserved bytes of channel {} are not 0", c);
  }
  ChannelInfo channel;
  channel.name.assign(text, length);
  channel.group = load<uint16_t>(entry, chan::kGroup);
  channel.type = static_cast<DataType>(load<uint16_t>(entry, chan::kDtype));
  channel.semantic = load<uint16_t>(entry, chan::kSemantic);
  channel.scope = static_cast<Scope>(load<uint16_t>(entry, chan::kScope));
  if (minor > kMinorVersion && channel.semantic > static_cast<uint16_t>(Semantic::kBits)) {
    channel.semantic = static_cast<uint16_t>(Semantic::kNotStated);
  }
  return channel;
}

}  // namespace

Judged<void> check_channels(const std::vector<ChannelInfo>& channels) {
  SPOOL_JUDGE(check_range("channel_count", channels.size(), kMinChannels, kMaxChannels));
  for (size_t c = 0; c < channels.size(); ++c) {
    SPOOL_JUDGE(check_channel(channels[c], c));
    SPOOL_JUDGE(check_neighbours(channels, c));
  }
  SPOOL_JUDGE(check_radiance(channels));
  return check_range("group_count", channels.back().group + 1u, 1, kMaxGroups);
}

Judged<void> check_dump_header(const DumpHeader& header) {
  SPOOL_JUDGE(check_image(header));
  SPOOL_JUDGE(check_channels(header.channels));
  return check_volume(header);
}

Judged<DumpHeader> parse_dump_header(std::span<const std::byte> imag_bytes,
                                     std::span<const std::byte> chan_bytes,
                                     const FileHeader& file) {
  const auto field = [&](size_t offset) { return load<uint32_t>(imag_bytes, offset); };
  DumpHeader header;
  header.width = field(imag::kWidth);
  header.height = field(imag::kHeight);
  header.tile_size = field(imag::kTileSize);
  header.spp = field(imag::kSpp);
  header.block_spp = field(imag::kBlockSpp);
  header.pixel_filter = static_cast<PixelFilter>(field(imag::kPixelFilter));
  header.colour_space = static_cast<ColourSpace>(field(imag::kColourSpace));
  header.sample_order = static_cast<SampleOrder>(field(imag::kSampleOrder));
  header.uuid = file.dump_uuid;
  if (file.minor <= kMinorVersion && !all_zero(imag_bytes.subspan(imag::kReserved))) {
    return violates(kInvalid, "reserved bytes of IMAG are not 0");
  }
  const uint32_t channel_count = field(imag::kChannelCount);
  if (uint64_t{channel_count} * kUnit != chan_bytes.size()) {
    return violates(kInvalid, "IMAG says {} channels, CHAN has {}", channel_count,
                    chan_bytes.size() / kUnit);
  }
  for (size_t c = 0; c < channel_count; ++c) {
    auto channel = parse_channel(chan_bytes.subspan(c * kUnit, kUnit), c, file.minor);
    if (!channel) return tl::unexpected(std::move(channel).error());
    header.channels.push_back(std::move(*channel));
  }
  SPOOL_JUDGE(check_dump_header(header));
  const uint32_t group_count = field(imag::kGroupCount);
  if (group_count != header.channels.back().group + 1u) {
    return violates(kInvalid, "IMAG says {} groups, CHAN has {}", group_count,
                    header.channels.back().group + 1);
  }
  return header;
}

UnitBytes encode_imag(const DumpHeader& header) {
  UnitBytes bytes{};
  const std::span out(bytes);
  store(out, imag::kWidth, header.width);
  store(out, imag::kHeight, header.height);
  store(out, imag::kTileSize, header.tile_size);
  store(out, imag::kSpp, header.spp);
  store(out, imag::kBlockSpp, header.block_spp);
  store(out, imag::kGroupCount, header.channels.back().group + 1u);
  store(out, imag::kChannelCount, static_cast<uint32_t>(header.channels.size()));
  store(out, imag::kPixelFilter, header.pixel_filter);
  store(out, imag::kColourSpace, header.colour_space);
  store(out, imag::kSampleOrder, header.sample_order);
  return bytes;
}

UnitBytes encode_channel(const ChannelInfo& channel) {
  UnitBytes bytes{};
  const std::span out(bytes);
  std::memcpy(bytes.data() + chan::kName, channel.name.data(),
              std::min(channel.name.size(), kMaxNameBytes));
  store(out, chan::kGroup, channel.group);
  store(out, chan::kDtype, channel.type);
  store(out, chan::kSemantic, channel.semantic);
  store(out, chan::kScope, channel.scope);
  return bytes;
}

}  // namespace spool::format
