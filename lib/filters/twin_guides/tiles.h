// The tiles in which twin_guides works: what one of them reads and writes stays in a core's cache.
#pragma once

#include <cstddef>

#include "lib/core/parallel.h"
#include "lib/core/rectangle.h"

namespace spool {

// With the window's default radius of 6 on either side a row is 64 pieces, four wide vectors.
inline constexpr int kTileWidth = 52, kTileHeight = 40;

// body(tile) for every tile of the image, in parallel.
template <class Body>
void parallel_tiles(int width, int height, Body&& body) {
  const int across = (width + kTileWidth - 1) / kTileWidth;
  const int down = (height + kTileHeight - 1) / kTileHeight;
  parallel_for(
      static_cast<std::size_t>(across) * static_cast<std::size_t>(down), [&](std::size_t i) {
        const int x0 = static_cast<int>(i) % across * kTileWidth;
        const int y0 = static_cast<int>(i) / across * kTileHeight;
        body(intersect({x0, y0, x0 + kTileWidth, y0 + kTileHeight}, {0, 0, width, height}));
      });
}

}  // namespace spool
