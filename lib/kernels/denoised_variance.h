// Variances of samples, averaged over the neighbours that a test of variances cannot separate:
// StatER, from descriptions [Sakai25].
//
//   l = ln(c s^2),   c = n / (n - z),   e^2 = c^2 (kurtosis - (n - 3) / n) / (n - 1)   [Bonett06]
//   q serves p   iff (l_p - l_q)^2 <= z^2 (e_p^2 + e_q^2) in every channel
//   variance(p) = mean of s_q^2 over those that serve (pair_filter.h)
//
// With film positions the part of s^2 that a plane through the piece explains can be taken off: an
// even neighbour of the same slope is no noisier for it,
//
//   s^2 := max(s^2 - max(12 (cov_x^2 + cov_y^2) - 2 s^2 / n, 0), s^2 / 20)
//
// 1/12: variance of a place in a piece; 2 s^2 / n: what noise alone explains. Slow twin:
// tests/reference/stater_reference.h.
#pragma once

#include "lib/kernels/pair_filter.h"
#include "lib/statistics/transformed_moments.h"

namespace spool {

inline constexpr double kVarianceQuantile = 2.80703;  // z, two-sided 0.5 %

struct SampleVariances {
  RgbImage value;           // [c][y][x] s^2; pieces of less than 4 samples as in variance_of_mean.h
  RgbImage log, log_error;  // l, e^2
};

// `moments` with the fourth. A piece without samples has its neighbours' variance.
SampleVariances sample_variances(const TransformedMoments& moments, const CountImage& n,
                                 int pieces_per_side);

// Takes the slope's part off.
void correct_for_slope(SampleVariances& variances, const FilmCovariance& film, const CountImage& n);

// `count`: n [y][x]; where no neighbour of an empty piece serves, the variance stays.
RgbImage denoised_variance(const SampleVariances& variances, const PairFeatures& features,
                           const Image<float>& count, const PairWindow& window);

Image<float> float_counts(const CountImage& n);

}  // namespace spool
