// SSIM and MS-SSIM maps of two grey images in [0, 1] [WangEtAl04], [WangSimoncelliBovik03].
//
// Gaussian window of 11 x 11, sigma 1.5, valid part only; K1 = 0.01, K2 = 0.03, L = 1. Images
// smaller than the window take the largest odd window that fits. A map is NaN within 5 pixels of
// the border and wherever the window holds a pixel that is NaN (not judged).
#pragma once

#include <vector>

#include "lib/core/image.h"

namespace spool {

struct SimilarityMaps {
  Plane ssim;                // luminance * contrast * structure
  Plane contrast_structure;  // without the luminance term
};

inline constexpr int kSsimWindow = 11;
// The window used for an image of this size.
int ssim_window(int width, int height);

SimilarityMaps ssim_maps(const Plane& a, const Plane& b);

// Scales of MS-SSIM: 5 from 176 pixels on, as many as leave 11 pixels below that, at least 1.
int ms_ssim_scales(int width, int height);
// Weights of the first `scales` scales, summing to 1.
std::vector<double> ms_ssim_weights(int scales);
// Maps of each scale; scale j is the image averaged over 2^j x 2^j pixels (an odd last row or
// column is dropped). At most `most` scales.
std::vector<SimilarityMaps> ms_ssim_maps(Plane a, Plane b, int most = 5);
// product of max(contrast_structure_j, 0)^weight_j, with max(ssim, 0) at the last scale.
double ms_ssim_value(const std::vector<double>& scale_means, const std::vector<double>& weights);

}  // namespace spool
