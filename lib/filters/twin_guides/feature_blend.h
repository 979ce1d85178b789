// Means of images under weights that recorded features alone give, on one tile.
//
//   e(p, q) = max(0, max_c ((f_p - f_q)^2 - (v_p + min(v_p, v_q))) / (v_p + v_q + tau))
//   w       = max(0, exp(-e - |p - q|^2 / (2 sigma^2)) - exp(-8))
//   mean    = sum w y / sum w,   variance of it = sum w^2 v / (sum w)^2
//
// q runs over the window of `radius` inside the image. Distances of features are those of
// [RousselleKnausZwicker12] for colours; the weight of the far end is taken off so that no
// neighbour enters with a jump.
// Slow twin: tests/reference/twin_guides_reference.h.
#pragma once

#include <span>
#include <vector>

#include "lib/core/image.h"

namespace spool {

// Features of pieces [channel][y][x], brought to a range of a few units, with variances.
struct FeatureImages {
  std::vector<Image<float>> value, variance;
};

struct BlendOptions {
  float tau = 1e-3f;
  int radius = 2;
  double sigma = 0.7;
};

// [image][y][x] from the tile's corner.
struct Blend {
  std::vector<Image<float>> mean, variance;
};

Blend feature_blend(const Rectangle& tile, std::span<const Image<float>* const> values,
                    std::span<const Image<float>* const> variances, const FeatureImages& features,
                    const BlendOptions& options);

}  // namespace spool
