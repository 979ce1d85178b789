// The anisotropic mean of each piece's neighbourhood.
//
//   delta  = width along the direction from the piece to the sample          [LiuZheng (12)]
//   omega  = exp(-dis^2 / (2 delta^2)), 1 at distance 0                      [LiuZheng (11)]
//   pixel  = sum of omega L / sum of omega over the window of size 2^k       [LiuZheng (10)]
//
// The window is clipped to the grid; empty pieces have weight 0. Sums are double and taken as
// centre + sum of omega (L - centre) / sum of omega, which keeps a constant exactly. Weights are T
// (float or double) by exponential.h. Where every weight vanishes, the piece's filled mean stays.
// Variance: sum of omega^2 v / (sum of omega)^2 for independent values of variance v.
// Slow twin: tests/reference/anisotropic_filter_reference.h.
#pragma once

#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/filters/directional/filter_width.h"
#include "lib/filters/directional/options.h"

namespace spool {

struct FilterInput {
  const CountImage& n;       // samples of each piece
  const CountImage& level;   // k: the filter's size is 2^k; 0 leaves the mean as it is
  const RgbImage& mean;      // L of each piece, empty pieces filled
  const RgbImage& variance;  // of `mean`
};

struct FilteredPieces {
  RgbImage image;     // [c][y][x]
  RgbImage variance;  // of `image`
};

// Samples at the centres of their pieces: L is the mean, a piece counts 1 or n. `level` as in
// FilterInput. `pieces` are the means and their variances before, the filtered ones after.
template <class T>
void filter_in_place(const CountImage& n, const CountImage& level, const FilterWidths<T>& widths,
                     const FilterOptions& options, FilteredPieces& pieces, GuardCounts& guards);

// Multiplies the variance of filtered pieces by that factor, sigma = sigma_max 2^level.
void correct_variance(const Taps& taps, const CountImage& level, double sigma_max,
                      const FilterOptions& options, RgbImage& variance);

}  // namespace spool
