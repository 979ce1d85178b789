// A Gaussian that is long along the picture's structure and short across it, for the coarser level
// of the guides: along an edge a guide may be smooth, across it it shall show what is there.
//
//   l         log(max(mean of the pilot's channels, 0) + kLogFloor L), blurred with G_1
//   a, b, c   G_2 of gx gx, gx gy, gy gy;      gx, gy: differences of l over two pieces
//   coherence sqrt((a - c)^2 + 4 b^2) / (a + c + 1e-4)
//   f         1 + stretch coherence^2;         long axis sigma f, short axis sigma / f
//
// The short axis is that of the gradient. The area stays, so noise falls as much as under G_sigma.
// Weights end at 0 (less e^-7) within 5 pieces, more where sigma or the stretch are larger than the
// defaults: max(5, sqrt(14) sigma, 5/3 sigma (1 + stretch)), rounded up.
// Slow twin: tests/reference/twin_guides_reference.h.
#pragma once

#include <array>

#include "lib/filters/twin_guides/sample_moments.h"

namespace spool {

// What the guides are made of, [P, t][channel]: the pilot and the mean of the logarithms
// (guides.h), with variances, unblurred or on one level.
struct GuideSources {
  std::array<FloatRgb, 2> mean, variance;
};

// `scene_luminance` in units.
GuideSources blur_along(const GuideSources& sources, double sigma, double stretch,
                        double scene_luminance);

}  // namespace spool
