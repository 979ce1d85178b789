#include "lib/pool/file_blocks.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "formats/half_float.h"

namespace spool {
namespace {

using format::DataType;
using format::SpoolReader;

static_assert(std::endian::native == std::endian::little,
              "samples are used as they lie in the file");

struct BlockPlace {
  std::uint32_t tile, block;
};
BlockPlace place_of(const SpoolReader& file, std::size_t index) {
  return {static_cast<std::uint32_t>(index / file.blocks()),
          static_cast<std::uint32_t>(index % file.blocks())};
}

std::size_t values_a_channel(const SpoolReader& file, BlockPlace place) {
  const format::PixelRect tile = file.tile_rect(place.tile);
  return std::size_t{tile.width()} * tile.height() * file.block_count(place.block);
}

bool can_be_mapped(const SpoolReader& file, const format::LayerInfo& layer, BlockPlace place) {
  return layer.type == DataType::kFloat32 && file.is_raw(layer.group, place.tile, place.block);
}

tl::unexpected<Error> missing(const SpoolReader& file, BlockPlace place) {
  const format::PixelRect rect = file.tile_rect(place.tile);
  const std::uint32_t begin = file.block_begin(place.block);
  return fail(ErrorCode::kDamage,
              "{}: samples {}-{} of tile {} (pixels {},{} to {},{}) were not recorded: record "
              "them, or use a recording that is complete",
              file.path().string(), begin, begin + file.block_count(place.block) - 1, place.tile,
              rect.x0, rect.y0, rect.x1 - 1, rect.y1 - 1);
}

// Plain floats are read to where they stay: a recording larger than memory is mostly this.
// Of a block that holds other layers, too, only the layer's `count` values from `first` on stay.
Result<BlockValues> read_floats(const SpoolReader& file, std::uint16_t group, BlockPlace place,
                                std::size_t first, std::size_t count) {
  const auto all =
      static_cast<std::size_t>(file.raw_bytes(group, place.tile, place.block)) / sizeof(float);
  auto held = std::make_shared_for_overwrite<float[]>(all);
  SPOOL_TRY(file.read_raw_block(group, place.tile, place.block,
                                std::as_writable_bytes(std::span(held.get(), all))));
  if (all == count) return BlockValues{held.get(), held};
  const auto part = std::make_shared_for_overwrite<float[]>(count);
  std::copy_n(held.get() + first, count, part.get());
  return BlockValues{part.get(), part};
}

// The layer's part of a block, whose first value is `first`.
BlockValues decoded(const std::vector<std::byte>& block, DataType type, std::size_t first,
                    std::size_t count) {
  auto held = std::make_shared_for_overwrite<float[]>(count);
  if (type == DataType::kFloat32) {  // it was compressed
    std::memcpy(held.get(), block.data() + first * sizeof(float), count * sizeof(float));
    return {held.get(), held};
  }
  for (std::size_t i = 0; i < count; ++i) {
    std::uint16_t half = 0;
    std::memcpy(&half, block.data() + (first + i) * sizeof(half), sizeof(half));
    held[i] = format::half_to_float(half);
  }
  return {held.get(), held};
}

}  // namespace

LayerGrid layer_grid(const format::DumpHeader& header) {
  return {static_cast<int>(header.width), static_cast<int>(header.height),
          static_cast<int>(header.spp), static_cast<int>(header.tile_size),
          static_cast<int>(header.block_spp)};
}

BlockReader file_blocks(std::shared_ptr<const SpoolReader> file, const format::LayerInfo& layer,
                        FileAccess access) {
  return [file = std::move(file), layer, access](std::size_t index) -> Result<BlockValues> {
    const BlockPlace place = place_of(*file, index);
    if (!file->has_block(layer.group, place.tile, place.block)) return missing(*file, place);
    const std::size_t plane = values_a_channel(*file, place);
    const std::size_t first = layer.first_channel * plane;
    if (access == FileAccess::kMap && can_be_mapped(*file, layer, place)) {
      SPOOL_ASSIGN(const auto bytes, file->map_block(layer.group, place.tile, place.block));
      // Payloads start at a multiple of 64.
      return BlockValues{reinterpret_cast<const float*>(bytes.data()) + first, nullptr};
    }
    const std::size_t count = layer.channel_count * plane;
    if (can_be_mapped(*file, layer, place)) {
      return read_floats(*file, layer.group, place, first, count);
    }
    SPOOL_ASSIGN(const auto bytes, file->read_block(layer.group, place.tile, place.block));
    return decoded(bytes, layer.type, first, count);
  };
}

PieceReader file_pieces(std::shared_ptr<const SpoolReader> file, const format::LayerInfo& layer) {
  BlockReader whole = file_blocks(file, layer, FileAccess::kMap);
  return [file = std::move(file), layer, whole = std::move(whole)](
             std::size_t index, std::size_t piece, Again again,
             const PieceLook& look) -> Result<BlockValues> {
    const BlockPlace place = place_of(*file, index);
    const std::size_t plane = values_a_channel(*file, place);
    const std::size_t first = layer.first_channel * plane, count = layer.channel_count * plane;
    if (file->has_block(layer.group, place.tile, place.block) &&
        can_be_mapped(*file, layer, place)) {
      const auto look_at = [&](std::span<const std::byte> bytes, std::size_t offset) {
        const std::size_t at = offset / sizeof(float);
        if (at < first || at >= first + count) return;  // of another layer of the group
        look(reinterpret_cast<const float*>(bytes.data()), at - first);
      };
      SPOOL_ASSIGN(const auto bytes,
                   file->map_block(layer.group, place.tile, place.block, piece * sizeof(float),
                                   again == Again::kExpected ? SpoolReader::Pieces::kMapped
                                                             : SpoolReader::Pieces::kCopied,
                                   look_at));
      return BlockValues{reinterpret_cast<const float*>(bytes.data()) + first, nullptr};
    }
    SPOOL_ASSIGN(BlockValues values, whole(index));
    for (std::size_t at = 0; at < count; at += piece)
      look(values.values + at, at);
    return values;
  };
}

std::uint64_t unmapped_bytes(const SpoolReader& file, const format::LayerInfo& layer,
                             FileAccess access) {
  std::uint64_t bytes = 0;
  for (std::size_t i = 0; i < std::size_t{file.tiles()} * file.blocks(); ++i) {
    const BlockPlace place = place_of(file, i);
    if (access == FileAccess::kMap && can_be_mapped(file, layer, place)) continue;
    bytes += layer.channel_count * values_a_channel(file, place) * sizeof(float);
  }
  return bytes;
}

}  // namespace spool
