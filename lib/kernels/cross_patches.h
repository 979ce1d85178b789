// Cross non-local means: patches of the image and features together weigh a fixed window; each
// tolerance of the patches has an unbiased estimate of its risk [LiWuChuang12].
//
//   D_pq = mean over channels and |b| <= f of (y_{p+b} - y_{q+b})^2, 0 where either is outside
//   w_pq = exp(-D_pq / (2 sigma^2)) * feature weight,      |q - p| <= r in x and y, cut at the
//   border F    = sum of w_pq y_q / sum of w_pq,   the same weights for the image itself SURE =
//   mean over channels of (F - y)^2 + 2 v dF/dy - v
//
// y, v: the image and its variance after the small pixel filter, exposed. dF/dy at p itself has
// three parts: the own weight, patches that p is the middle of, patches of p that hold p elsewhere.
// Weights are float, sums double; a pixel's sums run over the window row by row, so bits do not
// depend on threads. Slow twin: tests/reference/cross_patches_reference.h.
#pragma once

#include <vector>

#include "lib/core/image.h"
#include "lib/kernels/feature_guide.h"

namespace spool {

struct CrossPatchOptions {
  int window = 20;  // r, pieces
  int patch = 2;    // f
  // Exposed. The authors' program has a tenth of these, for pictures whose whites are near 1 and
  // whose mean luminance is about 0.1.
  std::vector<double> sigmas = {0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4};
};

// SURE of each sigma.
std::vector<Plane> cross_patch_risks(const FeatureGuide& guide, const RgbImage& y,
                                     const RgbImage& v, const CrossPatchOptions& options);

// `image` filtered with a sigma of each piece's own: `choice` is 1 + its index; 0 keeps the piece.
RgbImage cross_patch_means(const FeatureGuide& guide, const RgbImage& y, const RgbImage& image,
                           const CountImage& choice, const CrossPatchOptions& options);

}  // namespace spool
