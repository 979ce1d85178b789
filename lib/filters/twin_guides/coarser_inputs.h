// Inputs of the next scale, on one tile of a lattice: small means under the window's weights.
//
//   s_pq = w_pq exp(-|p - q|^2 / (2 1.2^2) + |p - q|^2 / (2 sigma^2)),   |dx|, |dy| <= 2
//   out  = sum s in / sum s       colours, differences, logarithms, features, positions
//
// So the Gaussian of the window becomes a small one, and edges of the guides stay. Taps of the next
// scale stand twice as far apart, on means over about as much. Slow twin:
// tests/reference/twin_guides_reference.h.
#pragma once

#include "lib/filters/twin_guides/fit_table.h"
#include "lib/filters/twin_guides/window_weights.h"

namespace spool {

// `sigma`: of the window; `table` was made of `inputs`. Writes the tile's pieces of `to`.
void coarser_inputs(const Lattice& lattice, const Rectangle& tile, const WindowWeights& weights,
                    double sigma, const FitTable& table, const ScaleInputs& inputs,
                    ScaleInputs& to);

}  // namespace spool
