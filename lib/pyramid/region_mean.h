// Sums and means over the regions of the multiscale sampler.
//
//   R_{k,x,y} = [x - 2^{k-1}, x + 2^{k-1} - 1] x [same in y], clipped to the grid; R_0 = (x, y)
//                                                                                   [LiuZheng (6)]
// Direct window sums, rows first, then columns, each in index order: a value depends on its region
// alone and a restricted computation gives the bits of the whole. Summed-area tables would let one
// firefly change the rounding of every region after it.
// Slow twin: tests/reference/region_mean_reference.h.
#pragma once

#include "lib/core/image.h"
#include "lib/core/rectangle.h"

namespace spool {

// The region of (x, y); level 0 .. 8.
Rectangle region(int x, int y, int level, const Rectangle& bounds);

Plane region_sum(const Plane& image, int level);
Plane region_mean(const Plane& image, int level);

// The same on `box` of `out` (same size as `image`, another plane).
void region_mean_box(const Plane& image, int level, const Rectangle& box, Plane& out);

// All (x, y) whose region meets `changed`.
Rectangle region_influence(const Rectangle& changed, int level, const Rectangle& bounds);

}  // namespace spool
