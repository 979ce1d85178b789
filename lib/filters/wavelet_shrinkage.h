// Wavelet shrinkage: the smoothest image that the samples allow, after the description of
// [OverbeckDonnerRamamoorthi09] (abstract only; the rest is ours).
//
//   w = DWT of the pixel means,  sigma_w^2 = their variances through the squared filters
//   w' = sign(w) max(0, |w| - lambda sigma_w)
//   image = inverse DWT; the coarsest scale coefficients are left as they are
//
// Decimated, square decomposition of the image padded by half-sample symmetry to multiples of 2^L.
// 9-7 wavelet: DC gain sqrt 2 per dimension, whole-sample symmetric borders. Negative
// results are kept. lambda = 0 returns the input. A footprint holds what each coefficient keeps of
// itself; channels keep different shares, so a tap's weight is the mean of three.
// Slow twin: tests/reference/wavelet_transform_reference.h.
#pragma once

#include "lib/filters/filter.h"
#include "lib/filters/wavelet_transform.h"

namespace spool {

struct WaveletShrinkageOptions {
  int levels = 4;  // L
  double lambda = 1.0;
};

Result<Reconstruction> reconstruct_wavelet_shrinkage(const Selection& selection,
                                                     const SamplePool& pool,
                                                     const WaveletShrinkageOptions& options,
                                                     const FilterContext& context);

Filter wavelet_shrinkage_filter();

}  // namespace spool
