#include "formats/spool_reader.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <system_error>

#include "formats/byte_io.h"
#include "formats/checked_math.h"
#include "formats/crc32.h"
#include "formats/header_rules.h"
#include "formats/open_dump.h"
#include "formats/stored_value.h"

namespace spool::format {
namespace {

// The earliest time where it is not known: the file was renamed or removed.
std::filesystem::file_time_type last_change(const OpenDump& dump) {
  std::error_code status;
  return std::filesystem::last_write_time(dump.file.path(), status);
}

}  // namespace

struct SpoolReader::State {
  explicit State(OpenDump opened)
      : dump(std::move(opened)), modified(last_change(dump)), verified(dump.entries.size()) {}

  OpenDump dump;
  std::once_flag mapped_once;
  Result<FileMapping> mapping;
  std::atomic<bool> mapped{false};                        // `mapping` is there
  std::atomic<std::filesystem::file_time_type> modified;  // of the bytes that were verified
  std::vector<std::atomic<bool>> verified;  // by entry: the mapped payload was checked

  std::optional<uint32_t> record(uint16_t group, uint32_t tile, uint32_t block) const {
    const auto slot = dump.geometry.slot(group, tile, block);
    if (!slot || dump.record_of_slot[*slot] == kNoRecord) return std::nullopt;
    return dump.record_of_slot[*slot];
  }

  template <class... Args>
  tl::unexpected<Error> refuse(ErrorCode code, fmt::format_string<Args...> format,
                               Args&&... args) const {
    return fail(code, "{}: {}", dump.file.path().string(),
                fmt::format(format, std::forward<Args>(args)...));
  }

  Result<uint32_t> find_record(uint16_t group, uint32_t tile, uint32_t block) const {
    if (const auto found = record(group, tile, block)) return *found;
    if (!dump.geometry.slot(group, tile, block)) {
      return refuse(ErrorCode::kUsage, "no block {} in tile {} of group {}: see `spool info`",
                    block, tile, group);
    }
    return refuse(ErrorCode::kData,
                  "block not recorded (group {} tile {} samples {}-{}): ask for fewer samples or "
                  "record it",
                  group, tile, dump.geometry.block_begin(group, block),
                  uint64_t{dump.geometry.block_begin(group, block)} +
                      dump.geometry.block_count(group, block) - 1);
  }

  // Where a raw payload lies in the mapping, which is made the first time.
  Result<std::span<const std::byte>> mapped_payload(const IndexEntry& entry) {
    if (entry.header.codec != 0) {
      return refuse(ErrorCode::kUsage, "block is compressed ({}): read it instead of mapping it",
                    describe(entry.header, entry.offset));
    }
    std::call_once(mapped_once, [&] {
      mapping = FileMapping::create(dump.file, dump.file_bytes);
      mapped.store(mapping.has_value(), std::memory_order_release);
    });
    if (!mapping) return tl::unexpected(mapping.error());
    return mapping->bytes().subspan(entry.offset + kUnit, entry.header.stored_bytes);
  }

  // Whether blocks that were verified and handed out hold other bytes now. They are read again only
  // when the file was touched.
  bool overwritten() {
    const auto now = last_change(dump);
    if (now == modified.load(std::memory_order_acquire)) return false;
    for (size_t record = 0; record < verified.size(); ++record) {
      const IndexEntry& entry = dump.entries[record];
      if (entry.header.codec != 0 || !verified[record].load(std::memory_order_acquire)) continue;
      const auto payload =
          mapping->bytes().subspan(entry.offset + kUnit, entry.header.stored_bytes);
      if (crc32(payload) != entry.header.payload_crc32) return true;
    }
    modified.store(now, std::memory_order_release);
    return false;
  }

  // Two threads may both verify; only the first is counted, where the bytes were not read.
  Result<void> verify(uint32_t record, uint32_t crc, bool count) {
    const IndexEntry& entry = dump.entries[record];
    if (crc != entry.header.payload_crc32) {
      return tl::unexpected(file_error(
          dump.file.path(),
          {FailureClass::kDamaged, fmt::format("payload does not match its checksum ({})",
                                               describe(entry.header, entry.offset))}));
    }
    if (!verified[record].exchange(true, std::memory_order_acq_rel) && count)
      dump.file.count_read(entry.header.stored_bytes);
    return {};
  }

  Result<LayerInfo> find_scope(const std::optional<LayerInfo>& layer, std::string_view name,
                               Scope scope) const {
    constexpr std::array<std::string_view, 3> kScopes = {"sample", "pixel", "pass"};
    if (!layer) {
      return refuse(ErrorCode::kData, "no layer {}: see `spool info` for what was recorded", name);
    }
    if (layer->scope != scope) {
      return refuse(ErrorCode::kUsage, "layer {} has scope {}, not {}: read it by its scope", name,
                    kScopes[static_cast<size_t>(layer->scope)],
                    kScopes[static_cast<size_t>(scope)]);
    }
    if (layer->type == DataType::kUint32) {
      return refuse(ErrorCode::kUsage, "layer {} holds u32, not floats: read its blocks", name);
    }
    return *layer;
  }
};

namespace {

// count consecutive values from block[from] to out[0].
void copy_values(std::span<const std::byte> block, DataType type, size_t from, size_t count,
                 float* out) {
  for (size_t i = 0; i < count; ++i)
    out[i] = stored_value(block, type, from + i);
}

// The part of [begin, begin + count) that lies in [lower, lower + extent).
struct Overlap {
  uint32_t begin = 0;
  uint32_t end = 0;
};
Overlap overlap(uint32_t begin, uint32_t end, uint32_t lower, uint32_t upper) {
  return {std::max(begin, lower), std::min(end, upper)};
}

}  // namespace

SpoolReader::SpoolReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
SpoolReader::SpoolReader(SpoolReader&&) noexcept = default;
SpoolReader& SpoolReader::operator=(SpoolReader&&) noexcept = default;
SpoolReader::~SpoolReader() = default;

Result<SpoolReader> SpoolReader::open(const std::filesystem::path& path) {
  SPOOL_ASSIGN(OpenDump dump, open_dump(path));
  if (path.extension() == ".partial") {
    return tl::unexpected(file_error(
        path, {FailureClass::kIncomplete, "its writer never gave it its name (.partial)"}));
  }
  return SpoolReader(std::make_unique<State>(std::move(dump)));
}

const DumpHeader& SpoolReader::header() const {
  return state_->dump.header;
}
const std::vector<std::string>& SpoolReader::meta() const {
  return state_->dump.meta;
}
const std::filesystem::path& SpoolReader::path() const {
  return state_->dump.file.path();
}
uint64_t SpoolReader::file_bytes() const {
  return state_->dump.file_bytes;
}
uint32_t SpoolReader::tiles_x() const {
  return state_->dump.geometry.tiles_x();
}
uint32_t SpoolReader::tiles_y() const {
  return state_->dump.geometry.tiles_y();
}
uint32_t SpoolReader::blocks() const {
  return state_->dump.geometry.blocks();
}
uint32_t SpoolReader::group_count() const {
  return static_cast<uint32_t>(state_->dump.geometry.groups().size());
}
PixelRect SpoolReader::tile_rect(uint32_t tile) const {
  return state_->dump.geometry.tile_rect(tile);
}
// Group 0 has scope sample.
uint32_t SpoolReader::block_begin(uint32_t block) const {
  return state_->dump.geometry.block_begin(0, block);
}
uint32_t SpoolReader::block_count(uint32_t block) const {
  return state_->dump.geometry.block_count(0, block);
}
bool SpoolReader::complete() const {
  return state_->dump.missing_blocks == 0;
}
uint64_t SpoolReader::bytes_read() const {
  return state_->dump.file.bytes_read();
}

bool SpoolReader::has_block(uint16_t group, uint32_t tile, uint32_t block) const {
  return state_->record(group, tile, block).has_value();
}

bool SpoolReader::is_raw(uint16_t group, uint32_t tile, uint32_t block) const {
  const auto record = state_->record(group, tile, block);
  return record && state_->dump.entries[*record].header.codec == 0;
}

uint64_t SpoolReader::raw_bytes(uint16_t group, uint32_t tile, uint32_t block) const {
  return state_->dump.geometry.raw_bytes(group, tile, block);
}

Result<std::span<const std::byte>> SpoolReader::map_block(uint16_t group, uint32_t tile,
                                                          uint32_t block) const {
  State& state = *state_;
  SPOOL_ASSIGN(const uint32_t record, state.find_record(group, tile, block));
  SPOOL_ASSIGN(const auto payload, state.mapped_payload(state.dump.entries[record]));
  if (!state.verified[record].load(std::memory_order_acquire)) {
    const Result<void> verified = state.verify(record, crc32(payload), true);
    if (!verified) SPOOL_TRY(intact());
    SPOOL_TRY(verified);
  }
  return payload;
}

Result<std::span<const std::byte>> SpoolReader::map_block(uint16_t group, uint32_t tile,
                                                          uint32_t block, std::size_t piece,
                                                          Pieces pieces,
                                                          const PieceLook& look) const {
  State& state = *state_;
  SPOOL_ASSIGN(const uint32_t record, state.find_record(group, tile, block));
  const IndexEntry& entry = state.dump.entries[record];
  SPOOL_ASSIGN(const auto payload, state.mapped_payload(entry));
  // Whole pieces, few enough for a core's own cache.
  constexpr std::size_t kRun = std::size_t{1} << 16;
  const std::size_t run = std::max<std::size_t>(kRun / piece, 1) * piece;
  std::vector<std::byte> copy(pieces == Pieces::kCopied ? std::min(run, payload.size()) : 0);
  uint32_t crc = 0;
  for (std::size_t at = 0; at < payload.size(); at += run) {
    auto bytes = payload.subspan(at, std::min(run, payload.size() - at));
    if (pieces == Pieces::kCopied) {
      const auto read = std::span(copy).first(bytes.size());
      SPOOL_TRY(state.dump.file.read_at(entry.offset + kUnit + at, read));
      bytes = read;
    }
    crc = crc32(bytes, crc);
    for (std::size_t i = 0; i < bytes.size(); i += piece)
      look(bytes.subspan(i, std::min(piece, bytes.size() - i)), at + i);
  }
  const Result<void> verified = state.verify(record, crc, pieces == Pieces::kMapped);
  if (!verified) SPOOL_TRY(intact());
  SPOOL_TRY(verified);
  return payload;
}

Result<void> SpoolReader::intact() const {
  if (!state_->mapped.load(std::memory_order_acquire)) return {};
  if (!state_->overwritten() && !state_->mapping->lost()) return {};
  return fail(ErrorCode::kDamage,
              "{}: was cut, overwritten or could not be read while it was in use: run `spool "
              "check`, then start again",
              state_->dump.file.path().string());
}

Result<std::vector<std::byte>> SpoolReader::read_block(uint16_t group, uint32_t tile,
                                                       uint32_t block) const {
  SPOOL_ASSIGN(const uint32_t record, state_->find_record(group, tile, block));
  const IndexEntry& entry = state_->dump.entries[record];
  SPOOL_ASSIGN(auto stored, read_payload(state_->dump.file, entry));
  auto plain = decode_block(entry.header, state_->dump.geometry, std::move(stored));
  if (!plain) {
    return tl::unexpected(file_error(
        state_->dump.file.path(),
        {plain.error().failure,
         fmt::format("{} ({})", plain.error().what, describe(entry.header, entry.offset))}));
  }
  return std::move(*plain);
}

Result<void> SpoolReader::read_raw_block(uint16_t group, uint32_t tile, uint32_t block,
                                         std::span<std::byte> bytes) const {
  const State& state = *state_;
  SPOOL_ASSIGN(const uint32_t record, state.find_record(group, tile, block));
  const IndexEntry& entry = state.dump.entries[record];
  if (entry.header.codec != 0 || entry.header.stored_bytes != bytes.size()) {
    return state.refuse(ErrorCode::kUsage, "block is compressed or has not {} bytes ({}): read it",
                        bytes.size(), describe(entry.header, entry.offset));
  }
  return read_payload_into(state.dump.file, entry, bytes);
}

std::vector<LayerInfo> SpoolReader::layers() const {
  std::vector<LayerInfo> layers;
  const auto& groups = state_->dump.geometry.groups();
  const auto& channels = header().channels;
  for (uint32_t c = 0; c < channels.size(); ++c) {
    const ChannelInfo& channel = channels[c];
    const std::string_view layer = layer_of(channel.name);
    if (layers.empty() || layers.back().name != layer) {
      layers.push_back({std::string(layer),
                        channel.group,
                        c - groups[channel.group].first_channel,
                        0,
                        channel.type,
                        channel.scope,
                        {}});
    }
    ++layers.back().channel_count;
    layers.back().components.push_back(channel.name.substr(layer.size() + 1));
  }
  return layers;
}

std::optional<LayerInfo> SpoolReader::find_layer(std::string_view layer) const {
  for (LayerInfo& candidate : layers()) {
    if (candidate.name == layer) return std::move(candidate);
  }
  return std::nullopt;
}

Result<std::vector<float>> SpoolReader::read_region(std::string_view layer_name, PixelRect rect,
                                                    uint32_t sample_begin,
                                                    uint32_t sample_count) const {
  const State& state = *state_;
  SPOOL_ASSIGN(const LayerInfo layer,
               state.find_scope(find_layer(layer_name), layer_name, Scope::kSample));
  const DumpHeader& image = header();
  if (rect.x0 >= rect.x1 || rect.y0 >= rect.y1 || rect.x1 > image.width || rect.y1 > image.height ||
      sample_count == 0 || !fits(sample_begin, sample_count, image.spp)) {
    return state.refuse(ErrorCode::kUsage,
                        "region [{}, {}) x [{}, {}) samples {}+{} is outside {}x{} with {} samples",
                        rect.x0, rect.x1, rect.y0, rect.y1, sample_begin, sample_count, image.width,
                        image.height, image.spp);
  }
  const uint32_t sample_end = sample_begin + sample_count;
  const uint32_t size = image.tile_size;
  const uint32_t first_block = sample_begin / image.block_spp;
  const uint32_t last_block = (sample_end - 1) / image.block_spp;
  // All blocks must exist before memory is taken for their samples.
  for (uint32_t ty = rect.y0 / size; ty <= (rect.y1 - 1) / size; ++ty) {
    for (uint32_t tx = rect.x0 / size; tx <= (rect.x1 - 1) / size; ++tx) {
      for (uint32_t block = first_block; block <= last_block; ++block) {
        SPOOL_TRY(state.find_record(layer.group, ty * tiles_x() + tx, block));
      }
    }
  }
  const auto values = checked_product(
      {layer.channel_count, rect.height(), rect.width(), sample_count, sizeof(float)});
  if (!values || *values > SIZE_MAX) {
    return state.refuse(ErrorCode::kUsage, "region is too large for memory: read it in parts");
  }
  std::vector<float> out(static_cast<size_t>(*values / sizeof(float)));
  for (uint32_t ty = rect.y0 / size; ty <= (rect.y1 - 1) / size; ++ty) {
    for (uint32_t tx = rect.x0 / size; tx <= (rect.x1 - 1) / size; ++tx) {
      const uint32_t tile = ty * tiles_x() + tx;
      const PixelRect area = tile_rect(tile);
      const Overlap columns = overlap(rect.x0, rect.x1, area.x0, area.x1);
      const Overlap rows = overlap(rect.y0, rect.y1, area.y0, area.y1);
      for (uint32_t block = first_block; block <= last_block; ++block) {
        SPOOL_ASSIGN(const auto plain, read_block(layer.group, tile, block));
        const uint32_t begin = block_begin(block);
        const uint32_t stored = block_count(block);
        const Overlap samples = overlap(sample_begin, sample_end, begin, begin + stored);
        for (uint32_t c = 0; c < layer.channel_count; ++c) {
          for (uint32_t y = rows.begin; y < rows.end; ++y) {
            for (uint32_t x = columns.begin; x < columns.end; ++x) {
              const size_t pixel =
                  (size_t{layer.first_channel + c} * area.height() + y - area.y0) * area.width() +
                  x - area.x0;
              const size_t target =
                  ((size_t{c} * rect.height() + y - rect.y0) * rect.width() + x - rect.x0) *
                      sample_count +
                  samples.begin - sample_begin;
              copy_values(plain, layer.type, pixel * stored + samples.begin - begin,
                          samples.end - samples.begin, out.data() + target);
            }
          }
        }
      }
    }
  }
  return out;
}

Result<std::vector<float>> SpoolReader::read_pixel_layer(std::string_view layer_name) const {
  const State& state = *state_;
  SPOOL_ASSIGN(const LayerInfo layer,
               state.find_scope(find_layer(layer_name), layer_name, Scope::kPixel));
  for (uint32_t tile = 0; tile < tiles(); ++tile) {
    SPOOL_TRY(state.find_record(layer.group, tile, 0));
  }
  const DumpHeader& image = header();
  std::vector<float> out(size_t{layer.channel_count} * image.height * image.width);
  for (uint32_t tile = 0; tile < tiles(); ++tile) {
    SPOOL_ASSIGN(const auto plain, read_block(layer.group, tile, 0));
    const PixelRect area = tile_rect(tile);
    for (uint32_t c = 0; c < layer.channel_count; ++c) {
      for (uint32_t y = area.y0; y < area.y1; ++y) {
        const size_t from =
            (size_t{layer.first_channel + c} * area.height() + y - area.y0) * area.width();
        const size_t target = (size_t{c} * image.height + y) * image.width + area.x0;
        copy_values(plain, layer.type, from, area.width(), out.data() + target);
      }
    }
  }
  return out;
}

Result<std::vector<float>> SpoolReader::read_pass_layer(std::string_view layer_name) const {
  const State& state = *state_;
  SPOOL_ASSIGN(const LayerInfo layer,
               state.find_scope(find_layer(layer_name), layer_name, Scope::kPass));
  const uint32_t spp = header().spp;
  std::vector<float> out(size_t{layer.channel_count} * spp);
  for (uint32_t block = 0; block < blocks(); ++block) {
    SPOOL_ASSIGN(const auto plain, read_block(layer.group, 0, block));
    const uint32_t stored = block_count(block);
    for (uint32_t c = 0; c < layer.channel_count; ++c) {
      copy_values(plain, layer.type, size_t{layer.first_channel + c} * stored, stored,
                  out.data() + size_t{c} * spp + block_begin(block));
    }
  }
  return out;
}

}  // namespace spool::format
