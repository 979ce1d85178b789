// Wavelet shrinkage: the smoothest image that the samples allow, after the description of
// [OverbeckDonnerRamamoorthi09] (abstract only; the rest is ours).
//
//   w = DWT of the pixel means,  sigma_w^2 = their variances through the squared filters
//   w' = sign(w) max(0, |w| - lambda sigma_w)   soft
//        w where |w| > lambda sigma_w, else 0   hard
//        soft with threshold sigma_w^2 / sigma_x, sigma_x^2 = max(0, mean w^2 - mean sigma_w^2)
//        over the band; 0 everywhere where sigma_x = 0                     bayes
//   image = inverse DWT; the coarsest scale coefficients are left as they are
//
// Decimated, square decomposition of the image padded by half-sample symmetry to multiples of 2^L.
// cdf97: DC gain sqrt 2 per dimension, whole-sample symmetric borders. haar shows blocks. Negative
// results are kept. lambda = 0 returns the input.
// Slow twin: tests/reference/wavelet_transform_reference.h.
#pragma once

#include "lib/filters/filter.h"
#include "lib/filters/wavelet_transform.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {

enum class Shrink { kSoft, kHard, kBayes };

struct WaveletShrinkageOptions {
  TransformWavelet wavelet = TransformWavelet::kCdf97;
  int levels = 4;  // L
  Shrink shrink = Shrink::kSoft;
  double lambda = 1.0;
  VarianceMode var_mode = VarianceMode::kAuto;
  double nu0 = 2.0;
  double key = 1.0;
};

OptionTable<WaveletShrinkageOptions> wavelet_shrinkage_option_table();

Result<Reconstruction> reconstruct_wavelet_shrinkage(const Selection& selection,
                                                     const SamplePool& pool,
                                                     const WaveletShrinkageOptions& options,
                                                     const FilterContext& context);

Filter wavelet_shrinkage_filter();

}  // namespace spool
