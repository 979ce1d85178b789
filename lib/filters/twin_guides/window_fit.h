// A ridge regression in the window of every piece, on one tile of a lattice, and its value at the
// piece.
//
//   y_q = C_q min(1, top / L(C_q))      the robust limit top of p (robust_limit.h), all channels
//                                       alike
//   u_q = (1, (Y_q - Y_p) / 10, (X_q - X_p) / 10, raw_q - F_p)
//   out = coefficient 0 of the fit of y on u with weights w; `ridge` is added to every entry of
//         the normal matrix's diagonal but the first
//
// Raw features of the neighbours stand against the clean ones of the piece: what lens and motion do
// to a neighbour's features they did to its colour as well, and the fit takes it off. Colours are
// fitted less that of the piece, so an even picture stays even to the bit. A value below 0 becomes
// 0, or the least of the window where that is below 0. The same fit of the differences of halves is
// one draw of the value's noise. Slow twin: tests/reference/twin_guides_reference.h.
#pragma once

#include "lib/filters/twin_guides/fit_table.h"
#include "lib/filters/twin_guides/window_weights.h"

namespace spool {

struct FitOptions {
  double ridge;
  double limit;
  const Plane& heavy;  // opened_limits.h
};

// Writes the tile's pieces of `to`. `table` holds the scale's `inputs` around the tile.
void window_fit(const Lattice& lattice, const Rectangle& tile, const WindowWeights& weights,
                const FitTable& table, const ScaleInputs& inputs, const FeatureImages& clean,
                const CountImage& n, const FitOptions& options, ScaleImages& to);

}  // namespace spool
