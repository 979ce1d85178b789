// Whole numbers of pieces - counts, levels - as numbers to calculate and to draw with.
#pragma once

#include "lib/core/image.h"

namespace spool {

inline Plane as_plane(const CountImage& counts) {
  Plane plane(counts.width(), counts.height());
  for (std::size_t i = 0; i < counts.size(); ++i)
    plane[i] = counts[i];
  return plane;
}

}  // namespace spool
