// How the samples of a layer are cut into blocks: tile t covers tile_size^2 pixels (cropped at the
// right and bottom, row after row), and its block b holds the samples [b * block_spp, ...) of each
// of them as [c][y][x][s] floats.
#pragma once

#include <algorithm>
#include <cstddef>

#include "lib/core/rectangle.h"

namespace spool {

struct LayerGrid {
  int width = 0, height = 0, spp = 0;
  int tile_size = 0;  // pixels
  int block_spp = 0;  // samples

  int tiles_x() const { return (width + tile_size - 1) / tile_size; }
  int tiles_y() const { return (height + tile_size - 1) / tile_size; }
  int tiles() const { return tiles_x() * tiles_y(); }
  int blocks() const { return (spp + block_spp - 1) / block_spp; }  // of a tile
  std::size_t count() const { return static_cast<std::size_t>(tiles()) * blocks(); }
  std::size_t index(int tile, int block) const {
    return static_cast<std::size_t>(tile) * blocks() + block;
  }

  Rectangle tile(int t) const {
    const int x = t % tiles_x() * tile_size, y = t / tiles_x() * tile_size;
    return {x, y, std::min(x + tile_size, width), std::min(y + tile_size, height)};
  }
  int first_sample(int block) const { return block * block_spp; }
  int samples(int block) const { return std::min(block_spp, spp - block * block_spp); }
};

}  // namespace spool
