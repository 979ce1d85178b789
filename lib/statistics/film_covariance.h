// How samples change with the place in their piece where they fell: what the slope of a picture
// adds to the variance of a piece.
#pragma once

#include "lib/core/image.h"
#include "lib/pool/sample_pool.h"

namespace spool {

struct FilmCovariance {
  RgbImage x, y;  // [c][y][x]: sums of (T - mean) (u - 1/2), u in [0, 1) across the piece
};

// Over the first n(x, y) samples of every piece, T as in transformed_moments.h with the same `unit`
// and `lambda`, `mean` its mean. Film positions were recorded.
FilmCovariance film_covariance(const SamplePool& pool, const CountImage& n, double unit,
                               double lambda, const RgbImage& mean);

}  // namespace spool
