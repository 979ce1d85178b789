#include "lib/kernels/pair_features.h"

#include <algorithm>
#include <cmath>

#include "lib/statistics/feature_statistics.h"

namespace spool {
namespace {

// Half of each variance is that of its 3 x 3 neighbourhood.
Plane smoothed(const Plane& variance) {
  Plane out(variance.width(), variance.height());
  const auto clamped = [&](int x, int y) {
    return variance(std::clamp(x, 0, variance.width() - 1),
                    std::clamp(y, 0, variance.height() - 1));
  };
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      double sum = 0.0;
      for (int v = -1; v <= 1; ++v) {
        for (int u = -1; u <= 1; ++u)
          sum += clamped(x + u, y + v);
      }
      out(x, y) = 0.5 * (variance(x, y) + sum / 9.0);
    }
  }
  return out;
}

}  // namespace

Image<float> to_float(const Plane& plane, double factor) {
  Image<float> image(plane.width(), plane.height());
  for (std::size_t i = 0; i < plane.size(); ++i)
    image[i] = static_cast<float>(factor * plane[i]);
  return image;
}

Result<PairFeatures> pair_features(const SamplePool& pool, const CountImage& n,
                                   const PairFeatureOptions& options, GuardCounts& guards) {
  PairFeatures features;
  for (const FeatureLayer& layer : pool.recording().features()) {
    if (layer.name != "albedo" && layer.name != "normal") continue;
    const double sigma = layer.name == "albedo" ? options.sigma_albedo : options.sigma_normal;
    const double scale = 1.0 / (sigma * std::sqrt(2.0));
    SPOOL_ASSIGN(const FeatureStatistics feature, feature_statistics(pool, n, layer, guards));
    for (std::size_t c = 0; c < feature.mean.size(); ++c) {
      features.value.push_back(to_float(feature.mean[c], scale));
      features.variance.push_back(
          to_float(options.noise ? smoothed(feature.variance[c]) : Plane(n.width(), n.height()),
                   scale * scale));
    }
  }
  return features;
}

}  // namespace spool
