// Means of images under the weights of a feature guide times Gaussians of the distance, tile by
// tile: nothing as large as the image is made.
//
//   mean(p) = sum of g_s(p - q) w_pq value_q / sum of g_s(p - q) w_pq,  |q - p| <= round(2 s)
//
// Windows are cut at the border. Weights are float, sums double; every piece's sums run over its
// neighbours row by row, so their bits depend neither on tiles nor on threads. Slow twin:
// tests/reference/cross_bilateral_reference.h.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "lib/core/image.h"
#include "lib/kernels/feature_guide.h"

namespace spool {

// A Gaussian and what it is applied to: `count` images from the one of index `first` on.
struct GuidedTarget {
  double scale = 1.0;  // s > 0, pieces
  std::size_t first = 0, count = 0;
};

// Of one target in one tile: [y][x] from the tile's corner.
struct GuidedMeans {
  std::vector<Plane> values;
  Plane weight;  // sum of the weights; the centre's is 1
};

// Calls `use` with every tile of the image and its means, [target]; in parallel.
void guided_means(
    const FeatureGuide& guide, std::span<const Plane* const> images,
    const std::vector<GuidedTarget>& targets,
    const std::function<void(const Rectangle& tile, const std::vector<GuidedMeans>& means)>& use);

}  // namespace spool
