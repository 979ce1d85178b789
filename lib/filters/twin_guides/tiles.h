// The tiles in which twin_guides works: what one of them reads and writes stays in a core's cache.
#pragma once

#include <cstddef>

#include "lib/core/parallel.h"
#include "lib/core/rectangle.h"
#include "lib/filters/twin_guides/lattice.h"

namespace spool {

// With the window's default radius of 6 on either side a row is 64 pieces, four wide vectors.
inline constexpr int kTileWidth = 52, kTileHeight = 40;

// Tiles of about one size that cover an image, row by row.
struct Tiling {
  int width, height, across, down;

  Tiling(int image_width, int image_height)
      : width(image_width),
        height(image_height),
        across((image_width + kTileWidth - 1) / kTileWidth),
        down((image_height + kTileHeight - 1) / kTileHeight) {}
  int count() const { return across * down; }
  Rectangle tile(int number) const {
    const int i = number % across, j = number / across;
    return {i * width / across, j * height / down, (i + 1) * width / across,
            (j + 1) * height / down};
  }
};

// body(tile) for every tile of the image, in parallel.
template <class Body>
void parallel_tiles(int width, int height, Body&& body) {
  const Tiling tiling(width, height);
  parallel_for(static_cast<std::size_t>(tiling.count()),
               [&](std::size_t i) { body(tiling.tile(static_cast<int>(i))); });
}

// body(lattice, tile) for every tile of every lattice of the image, in parallel. Lattices beside
// each other read the same lines of the cache, so they follow one another.
template <class Body>
void parallel_lattice_tiles(int width, int height, int step, Body&& body) {
  const Tiling largest((width + step - 1) / step, (height + step - 1) / step);
  const int lattices = step * step;
  const auto jobs = static_cast<std::size_t>(lattices) * static_cast<std::size_t>(largest.count());
  parallel_for(jobs, [&](std::size_t i) {
    const int job = static_cast<int>(i);
    const Lattice lattice = lattice_of(width, height, step, job % lattices);
    const Rectangle tile = intersect(largest.tile(job / lattices), lattice.bounds());
    if (!tile.empty()) body(lattice, tile);
  });
}

}  // namespace spool
