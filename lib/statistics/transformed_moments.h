// Moments of transformed samples: what tests compare that require a distribution nearer to a normal
// one.
//
//   T(x) = (x^lambda - 1) / lambda [BoxCox64],   T(x) = x for lambda = 1
//
// A negative sample counts as 0 for other lambda: a root is defined from there on. One pass, in
// double [Meng15].
#pragma once

#include "lib/core/image.h"
#include "lib/pool/sample_pool.h"

namespace spool {

struct TransformedMoments {
  RgbImage mean, m2, m3;  // [c][y][x]: mean of T, sums of (T - mean)^2 and (T - mean)^3
  RgbImage m4;            // of (T - mean)^4, where asked for
};

enum class HighestMoment { kThird, kFourth };

// Of the first n(x, y) samples of every piece, each times `unit` > 0; lambda > 0.
TransformedMoments transformed_moments(const SamplePool& pool, const CountImage& n, double unit,
                                       double lambda,
                                       HighestMoment highest = HighestMoment::kThird);

// How samples change with the place in their piece where they fell: what the slope of a picture
// adds to the variance of a piece.
struct FilmCovariance {
  RgbImage x, y;  // [c][y][x]: sums of (T - mean) (u - 1/2), u in [0, 1) across the piece
};

// Over the first n(x, y) samples of every piece, T as above with the same `unit` and `lambda`,
// `mean` its mean. Film positions were recorded.
FilmCovariance film_covariance(const SamplePool& pool, const CountImage& n, double unit,
                               double lambda, const RgbImage& mean);

}  // namespace spool
