#include "formats/interchange/export_file.h"

#include <algorithm>
#include <cstring>

#include "formats/byte_io.h"
#include "formats/half_float.h"
#include "formats/temporary_file.h"

namespace spool::interchange {
namespace {

using format::DataType;
using format::FileHandle;
using format::LayerInfo;
using format::PixelRect;
using format::Scope;
using format::SpoolReader;

// A tile's samples are gathered together up to this size.
constexpr uint64_t kGatherBytes = uint64_t{64} << 20;

// [y][x][s][c] of one layer out of blocks [c][y][x][s] that follow each other in one tile.
std::vector<std::byte> interleave(const std::vector<std::vector<std::byte>>& blocks,
                                  const std::vector<uint32_t>& samples, uint64_t pixels,
                                  uint32_t first_channel, uint32_t channels, uint32_t bytes) {
  uint64_t total = 0;
  for (uint32_t count : samples)
    total += count;
  std::vector<std::byte> out(pixels * total * channels * bytes);
  uint64_t before = 0;  // samples of earlier blocks
  for (size_t b = 0; b < blocks.size(); ++b) {
    const uint64_t count = samples[b];
    for (uint64_t c = 0; c < channels; ++c) {
      const std::byte* from = blocks[b].data() + (first_channel + c) * pixels * count * bytes;
      for (uint64_t p = 0; p < pixels; ++p) {
        for (uint64_t s = 0; s < count; ++s) {
          std::memcpy(&out[((p * total + before + s) * channels + c) * bytes], from, bytes);
          from += bytes;
        }
      }
    }
    before += count;
  }
  return out;
}

// f16 to f32, exact.
std::vector<std::byte> widen(const std::vector<std::byte>& halves) {
  std::vector<std::byte> out(halves.size() * 2);
  for (size_t i = 0; i < halves.size() / 2; ++i)
    format::store(std::span(out), 4 * i,
                  format::half_to_float(format::load<uint16_t>(halves, 2 * i)));
  return out;
}

// All samples of one tile into the array at `data_offset`.
Result<void> write_tile(const SpoolReader& dump, const LayerInfo& layer, DataType type,
                        uint32_t tile, uint64_t data_offset, FileHandle& out) {
  const bool pass = layer.scope == Scope::kPass, pixel = layer.scope == Scope::kPixel;
  const PixelRect rect = pass ? PixelRect{0, 0, 1, 1} : dump.tile_rect(tile);
  const uint64_t width = pass ? 1 : dump.header().width;
  const uint64_t spp = pixel ? 1 : dump.header().spp;
  const uint64_t pixels = uint64_t{rect.width()} * rect.height();
  const uint32_t bytes = format::bytes_per_value(layer.type);
  const uint64_t value = uint64_t{layer.channel_count} * format::bytes_per_value(type);
  const uint32_t blocks = pixel ? 1 : dump.blocks();
  const uint64_t full = pixel ? 1 : dump.block_count(0);
  const uint32_t step =
      static_cast<uint32_t>(std::max<uint64_t>(1, kGatherBytes / (pixels * full * value)));
  uint64_t begin = 0;
  for (uint32_t block = 0; block < blocks; block += step) {
    std::vector<std::vector<std::byte>> payloads;
    std::vector<uint32_t> samples;
    uint64_t count = 0;
    for (uint32_t b = block; b < std::min(blocks, block + step); ++b) {
      SPOOL_ASSIGN(auto payload, dump.read_block(layer.group, tile, b));
      payloads.push_back(std::move(payload));
      samples.push_back(pixel ? 1 : dump.block_count(b));
      count += samples.back();
    }
    auto values =
        interleave(payloads, samples, pixels, layer.first_channel, layer.channel_count, bytes);
    if (type != layer.type) values = widen(values);
    const bool whole = count == spp;
    const uint64_t run = (whole ? rect.width() : 1) * count * value;
    size_t at = 0;
    for (uint64_t y = rect.y0; y < rect.y1; ++y) {
      for (uint64_t x = rect.x0; x < rect.x1; x += whole ? rect.width() : 1) {
        const uint64_t to = data_offset + ((y * width + x) * spp + begin) * value;
        SPOOL_TRY(out.write_at(to, std::span(values).subspan(at, run)));
        at += run;
      }
    }
    begin += count;
  }
  return {};
}

}  // namespace

Result<void> write_whole_file(const std::filesystem::path& out, bool force,
                              const std::function<Result<void>(format::FileHandle&)>& fill) {
  SPOOL_TRY(format::refuse_existing_target(out, force));
  SPOOL_ASSIGN(format::TemporaryFile file, format::TemporaryFile::create(out));
  SPOOL_TRY(fill(file.file()));
  SPOOL_TRY(file.publish(force ? format::Replace::kWhatWasHere : format::Replace::kNothing));
  return format::sync_directory(out.parent_path());
}

Result<void> write_layer(const SpoolReader& dump, const LayerInfo& layer, DataType type,
                         uint64_t data_offset, FileHandle& out) {
  const uint32_t tiles = layer.scope == Scope::kPass ? 1 : dump.tiles();
  for (uint32_t tile = 0; tile < tiles; ++tile)
    SPOOL_TRY(write_tile(dump, layer, type, tile, data_offset, out));
  return {};
}

}  // namespace spool::interchange
