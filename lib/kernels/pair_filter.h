// Means over the neighbours that pass a test, weighted by distance and features [Sakai24].
//
//   q serves p   iff in every plane of a test  (M_p - M_q)^2 <= h_p + min(kappa h_p, h_q)
//   w_pq       = n_q exp(-|p - q|^2 / (2 sigma^2) - sum_f max(0, (f_p - f_q)^2 - V) / (1 + 2 V))
//   mean(p)    = sum of w_pq value_q / sum of w_pq,   |p - q| <= R,   V = V_p + V_q
//
// M: what is compared; h: squared half widths of its intervals. kappa = infinity is the symmetric
// test of Welch, kappa = 0 asks the centre's interval alone [Moon13]. f: features over sqrt(2)
// times their scale, V: the variance of their noise in the same unit. The centre always serves
// itself. Windows are cut at the border. Weights are float, sums double; every piece sums over its
// neighbours row by row, so the bits do not depend on threads. Slow twin:
// tests/reference/welch_reference.h.
#pragma once

#include <vector>

#include "lib/core/footprint.h"
#include "lib/core/image.h"

namespace spool {

inline constexpr double kSymmetricTest = 1e20;  // kappa = infinity: 0 times it is still a number

struct PairTest {
  std::vector<Image<float>> mean, half2;  // [plane][y][x]; h > 0. Empty: all serve
  double kappa = 0.0;
};

struct PairFeatures {
  std::vector<Image<float>> value, variance;  // [plane][y][x]
};

struct PairWindow {
  int radius = 20;      // R, pieces
  double sigma = 10.0;  // pieces
};

struct PairMeans {
  std::vector<Plane> value;  // [plane][y][x]; 0 where all weights are 0
  Plane weight, weight2;     // sums of w and of w^2
};

// `count`: n [y][x].
PairMeans pair_filter(const std::vector<const Plane*>& values, const PairTest& test,
                      const PairFeatures& features, const Image<float>& count,
                      const PairWindow& window);

// Adds `share` of the weights that make piece (x, y) to the footprint of its pixel, `q` pieces a
// side. Where all weights are 0 the piece stands for itself.
void add_pair_footprint(const RgbImage& values, const PairTest& test, const PairFeatures& features,
                        const Image<float>& count, const PairWindow& window, int x, int y,
                        double share, int q, Footprint& to);

}  // namespace spool
