// Recorded features as the weights of a cross-bilateral filter use them: means of the samples
// taken in float, one variance per feature.
//
//   w_pq = exp(-sum_f |f_p - f_q|^2 / (2 sigma_f^2 max(var_fp + var_fq, 0.01)))
//
// var_f is the variance of the samples - not of their mean: that is what the authors' program
// divides by, and a tolerance that shrinks with n keeps pixels apart whose features are as noisy as
// their radiance. It is the mean over the feature's channels. w_pq = w_qp to the bit.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/pool/sample_pool.h"

namespace spool {

struct FeatureGuide {
  static constexpr std::size_t kMostFeatures = 3;  // albedo, normal, depth
  static constexpr float kLeastVariance = 1e-2f;   // of two pieces together
  struct Feature {
    std::vector<Image<float>> mean;  // [channel][y][x] of pieces
    Image<float> variance;           // of the samples
    float factor = 1.0f;             // 1 / (2 sigma_f^2)
  };
  int width = 0, height = 0;
  std::vector<Feature> features;
};

// `tolerance` is sigma_f by the layer's name. One layer after the other is read and let go. Errors:
// those of reading.
Result<FeatureGuide> make_feature_guide(const SamplePool& pool, const CountImage& n,
                                        const std::function<double(std::string_view)>& tolerance,
                                        GuardCounts& guards);

// to[x - x0] = w of (x, y) with (x + dx, qy) for x = x0 .. x1 - 1, all of them inside the image.
void feature_weights(const FeatureGuide& guide, int y, int qy, int dx, int x0, int x1, float* to);

}  // namespace spool
