// The luminance that a neighbour may have in the fit of a piece (window_fit.h): a multiple of the
// geometric mean of the samples in its window, which a few bright pieces cannot move.
#pragma once

#include "lib/filters/twin_guides/sample_moments.h"
#include "lib/filters/twin_guides/window_weights.h"

namespace spool {

// top [y][x] from the tile's corner, in units.
Image<float> robust_limits(const Lattice& lattice, const Rectangle& tile,
                           const WindowWeights& weights, const Image<float>& log_luminance,
                           const CountImage& n, double limit);

}  // namespace spool
