// The luminance that a neighbour may have in the fit of a piece (window_fit.h): a multiple of the
// geometric mean of the samples in its window, which a few bright pieces cannot move.
//
//   tl' = max(tl, log(2 max(G_s luminance(C), 0) + 0.10 L)),   s = clamp_sigma
//   top = max(limit, 1.25 n_p) exp(sum w tl' / sum w)
//
// tl: mean logarithms of luminances. It lies far below the mean wherever few samples carry the
// light, and a limit made of it alone takes light that the clamp has left: docs/decisions.md, 0168.
// Slow twin: tests/reference/twin_guides_reference.h.
#pragma once

#include "lib/filters/twin_guides/sample_moments.h"
#include "lib/filters/twin_guides/window_weights.h"

namespace spool {

// tl' in place of tl; sigma in pieces.
void raise_logarithms(SampleMoments& moments, double sigma, const RadianceScale& scale);

// top [y][x] from the tile's corner, in units.
Image<float> robust_limits(const Lattice& lattice, const Rectangle& tile,
                           const WindowWeights& weights, const Image<float>& log_luminance,
                           const CountImage& n, double limit);

}  // namespace spool
