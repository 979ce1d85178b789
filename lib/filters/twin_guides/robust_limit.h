// The luminance that a neighbour may have in the fit of a piece (window_fit.h): a multiple of what
// the samples in its window agree on, which a few bright pieces cannot move.
//
//   m, s = sum w l / sum w, sqrt(sum (w (l - m))^2) / sum w,   l = luminance(C)
//   top  = max(limit, 1.25 n_p) max(exp(sum w tl / sum w), 3 (m - (2 - 1.5 h) s))
//
// tl: mean logarithms of luminances. It lies far below the mean wherever few samples carry the
// light. No piece with less than half of the weight raises the lower bound of the mean above 0
// alone, but where tails are heavy (h, opened_limits.h) few pieces are all there is:
// docs/decisions.md, 0170. Slow twin: tests/reference/twin_guides_reference.h.
#pragma once

#include "lib/filters/twin_guides/fit_table.h"
#include "lib/filters/twin_guides/window_weights.h"

namespace spool {

// top [y][x] from the tile's corner, in units. `heavy`: h of pieces, or nothing where it is 0.
Image<float> robust_limits(const Lattice& lattice, const Rectangle& tile,
                           const WindowWeights& weights, const FitTable& table,
                           const Image<float>& log_luminance, const CountImage& n,
                           const Plane& heavy, double limit);

}  // namespace spool
