#include "lib/image_io/exr_chunks.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace spool::exr {
namespace {

// Of Imf::Compression, in its order.
std::uint64_t lines_of_chunk(int compression) {
  constexpr std::array<std::uint64_t, 10> kLines = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
  return kLines[std::min<std::size_t>(static_cast<std::size_t>(compression), kLines.size() - 1)];
}

constexpr std::uint64_t divide_up(std::uint64_t a, std::uint64_t b) {
  return a / b + (a % b != 0 ? 1 : 0);
}

// Tiles along one side, level after level.
std::vector<std::uint64_t> tiles_of_levels(std::uint64_t side, std::uint64_t tile, bool round_up) {
  std::vector<std::uint64_t> tiles;
  for (;; side = round_up ? divide_up(side, 2) : side / 2) {
    tiles.push_back(divide_up(side, tile));
    if (side <= 1) return tiles;
  }
}

std::uint64_t count_tiles(const PartShape& part) {
  auto across =
      tiles_of_levels(static_cast<std::uint64_t>(part.width), part.tile_width, part.round_up);
  auto down =
      tiles_of_levels(static_cast<std::uint64_t>(part.height), part.tile_height, part.round_up);
  if (part.level_mode == 0) return across[0] * down[0];
  std::uint64_t count = 0;
  if (part.level_mode == 1) {  // as many levels as the longer side has
    const std::size_t levels = std::max(across.size(), down.size());
    across.resize(levels, 1);
    down.resize(levels, 1);
    for (std::size_t i = 0; i < levels; ++i)
      count += across[i] * down[i];
    return count;
  }
  for (const std::uint64_t a : across) {
    for (const std::uint64_t d : down)
      count += a * d;
  }
  return count;
}

}  // namespace

std::uint64_t count_chunks(const PartShape& part) {
  if (part.tiled) return count_tiles(part);
  return divide_up(static_cast<std::uint64_t>(part.height), lines_of_chunk(part.compression));
}

double chunk_bytes(const PartShape& part) {
  const std::uint64_t width = part.tiled ? part.tile_width : static_cast<std::uint64_t>(part.width);
  const std::uint64_t height = part.tiled ? part.tile_height : lines_of_chunk(part.compression);
  return static_cast<double>(width) * static_cast<double>(height) *
         static_cast<double>(part.pixel_bytes);
}

}  // namespace spool::exr
