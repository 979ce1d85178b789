#include "lib/exchange/dump_layers.h"

#include <algorithm>
#include <cstring>
#include <functional>

#include "formats/bounded_json.h"
#include "formats/geometry_rules.h"
#include "formats/half_float.h"
#include "formats/interchange/export_file.h"
#include "formats/temporary_file.h"

namespace spool::exchange {

using format::LayerInfo;
using format::Scope;
using nlohmann::json;

namespace {

uint64_t values_of(const LayerInfo& layer, const format::DumpHeader& header) {
  const uint64_t pixels = uint64_t{header.width} * header.height;
  return (layer.scope == Scope::kPass ? 1 : pixels) *
         (layer.scope == Scope::kPixel ? 1 : header.spp) * layer.channel_count;
}

template <class To, class From, class Convert>
void put(const ExrPlane& plane, size_t c, size_t channels, std::vector<std::byte>& values,
         Convert&& convert) {
  for (size_t p = 0; p < plane.values.size() / sizeof(From); ++p) {
    From from;
    std::memcpy(&from, &plane.values[p * sizeof(From)], sizeof(From));
    const To to = convert(from);
    std::memcpy(&values[(p * channels + c) * sizeof(To)], &to, sizeof(To));
  }
}

}  // namespace

PixelType pixel_type(format::DataType type) {
  return type == format::DataType::kFloat16   ? PixelType::kHalf
         : type == format::DataType::kFloat32 ? PixelType::kFloat
                                              : PixelType::kUint;
}

interchange::ElementType element_type(PixelType type) {
  return type == PixelType::kHalf    ? interchange::ElementType::kFloat16
         : type == PixelType::kFloat ? interchange::ElementType::kFloat32
                                     : interchange::ElementType::kUint32;
}

std::vector<std::byte> interleaved(std::span<const ExrPlane> planes, PixelType type) {
  const size_t channels = planes.size(), bytes = bytes_per_value(type);
  const size_t pixels = planes[0].values.size() / bytes_per_value(planes[0].type);
  std::vector<std::byte> values(pixels * channels * bytes);
  for (size_t c = 0; c < channels; ++c) {
    if (planes[c].type != type)
      put<float, uint16_t>(planes[c], c, channels, values, format::half_to_float);
    else if (bytes == 2)
      put<uint16_t, uint16_t>(planes[c], c, channels, values, std::identity());
    else
      put<uint32_t, uint32_t>(planes[c], c, channels, values, std::identity());
  }
  return values;
}

Result<void> require_complete(const format::SpoolReader& dump) {
  if (dump.complete()) return {};
  return fail(ErrorCode::kData, "{}: blocks are missing: an image has no place for holes",
              dump.path().string());
}

Result<ScratchLayers> unpack_layers(const format::SpoolReader& dump,
                                    const std::filesystem::path& out) {
  ScratchLayers scratch;
  SPOOL_ASSIGN(scratch.file, format::open_scratch_file(out));
  uint64_t end = 0;
  for (const LayerInfo& layer : dump.layers()) {
    SPOOL_TRY(interchange::write_layer(dump, layer, layer.type, end, scratch.file));
    scratch.layers.push_back({layer, end});
    end += values_of(layer, dump.header()) * format::bytes_per_value(layer.type);
  }
  return scratch;
}

ExrAttributes describe_dump(const format::SpoolReader& dump) {
  ExrAttributes attributes;
  json channels = json::array();
  for (const format::ChannelInfo& channel : dump.header().channels)
    channels.push_back({{"name", channel.name},
                        {"group", channel.group},
                        {"dtype", format::kDataTypeNames[static_cast<size_t>(channel.type)]},
                        {"semantic", channel.semantic},
                        {"scope", format::kScopeNames[static_cast<size_t>(channel.scope)]}});
  json meta = json::object();
  for (const std::string& text : dump.meta())
    meta.update(format::parse_json(text));
  std::string uuid;
  for (const uint8_t byte : dump.header().uuid)
    uuid += fmt::format("{:02x}", byte);
  const bool exchangeable = dump.header().sample_order == format::SampleOrder::kExchangeable;
  attributes.numbers = {{"spoolVersion", 1.0}, {"samplesPerPixel", dump.header().spp}};
  attributes.texts = {{"spoolChannels", channels.dump()},
                      {"spoolMeta", meta.dump(-1, ' ', false, json::error_handler_t::replace)},
                      {"spoolSampleOrder", exchangeable ? "exchangeable" : "renderer"},
                      {"spoolPixelFilter", "box"},
                      {"spoolSource", uuid}};
  return attributes;
}

std::string source_of(const ExrAttributes& attributes) {
  const auto found = attributes.texts.find("spoolSource");
  return found == attributes.texts.end() ? std::string() : found->second;
}

namespace {

tl::unexpected<Error> makes_no_sense(const std::string& name, const std::string& what) {
  return fail(ErrorCode::kData, "{}: attribute {} makes no sense: was it edited?", name, what);
}

Result<std::vector<ToldChannel>> told_channels(const json& channels, const std::string& name) {
  if (!channels.is_array()) return makes_no_sense(name, "spoolChannels");
  std::vector<ToldChannel> told;
  std::vector<format::ChannelInfo> together;  // by the rules of a recording, a group a layer
  for (const json& channel : channels) {
    if (!channel.is_object()) return makes_no_sense(name, "spoolChannels");
    const json given = channel.value("name", json()), scope = channel.value("scope", json()),
               semantic = channel.value("semantic", json(0U));
    const auto known = std::find(format::kScopeNames.begin(), format::kScopeNames.end(),
                                 scope.is_string() ? scope.get<std::string>() : "");
    if (!given.is_string() || known == format::kScopeNames.end() ||
        !semantic.is_number_unsigned() ||
        semantic.get<uint64_t>() > static_cast<uint64_t>(format::Semantic::kBits))
      return makes_no_sense(name, "spoolChannels");
    auto [layer, component] = split_channel(given.get<std::string>());
    told.push_back({layer, component, static_cast<Scope>(known - format::kScopeNames.begin()),
                    semantic.get<uint16_t>()});
    const bool same = told.size() > 1 && told[told.size() - 2].layer == layer;
    const auto group = together.empty() ? 0 : together.back().group + (same ? 0 : 1);
    together.push_back({given.get<std::string>(), static_cast<uint16_t>(group),
                        format::DataType::kFloat32, told.back().semantic, told.back().scope});
  }
  if (const auto valid = format::check_channels(together); !valid)
    return makes_no_sense(name, fmt::format("spoolChannels ({})", valid.error().what));
  return told;
}

}  // namespace

Result<std::optional<ToldDump>> told_dump(const ExrAttributes& attributes,
                                          const std::string& name) {
  const auto version = attributes.numbers.find("spoolVersion");
  if (version == attributes.numbers.end()) return std::nullopt;
  if (version->second != 1.0)
    return fail(ErrorCode::kData, "{}: spoolVersion {}: read it with a newer spool", name,
                version->second);
  const auto text = [&](const char* key) {
    const auto found = attributes.texts.find(key);
    return found == attributes.texts.end() ? std::string() : found->second;
  };
  ToldDump told;
  const json channels = format::parse_json(text("spoolChannels"), format::kMaxMetaBytes);
  const json meta = format::parse_json(text("spoolMeta"), format::kMaxMetaBytes);
  SPOOL_ASSIGN(told.channels, told_channels(channels, name));
  if (!meta.is_object()) return makes_no_sense(name, "spoolMeta");
  told.meta = meta;
  told.meta.erase("import");
  if (text("spoolSampleOrder") == "exchangeable")
    told.sample_order = format::SampleOrder::kExchangeable;
  else if (text("spoolSampleOrder") != "renderer")
    return makes_no_sense(name, "spoolSampleOrder");
  if (const auto found = attributes.numbers.find("samplesPerPixel");
      found != attributes.numbers.end())
    told.samples = found->second;
  return told;
}

bool ToldDump::has_pixel_layers() const {
  return std::ranges::any_of(channels,
                             [](const ToldChannel& c) { return c.scope == Scope::kPixel; });
}

std::vector<uint16_t> ToldDump::semantics(const std::string& layer) const {
  std::vector<uint16_t> found;
  for (const ToldChannel& channel : channels)
    if (channel.layer == layer) found.push_back(channel.semantic);
  return found;
}

}  // namespace spool::exchange
