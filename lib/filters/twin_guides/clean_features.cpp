#include "lib/filters/twin_guides/clean_features.h"

#include <cmath>
#include <utility>

#include "lib/filters/twin_guides/feature_fit.h"
#include "lib/filters/twin_guides/tiles.h"
#include "lib/kernels/pair_features.h"
#include "lib/kernels/truncated_filter.h"
#include "lib/pyramid/convolution.h"
#include "lib/statistics/feature_statistics.h"

namespace spool {
namespace {

constexpr double kLargestFeature = 4.0;  // albedos and normals beyond are no surface's
constexpr double kDarkAlbedo = 0.3;

// Sum of squares over sum: what is bright counts, however much background is black.
double typical_value(const std::vector<Plane>& channels) {
  double sum = 0.0, squares = 0.0;
  for (const Plane& channel : channels) {
    for (const double v : channel.pixels()) {
      sum += std::abs(v);
      squares += v * v;
    }
  }
  return sum > 0.0 ? squares / sum : 0.0;
}

// What brings dark albedos up to kDarkAlbedo: textures of tar and rust are textures.
double brightening(const FeatureStatistics& feature) {
  if (feature.layer.name != "albedo") return 1.0;
  const double value = typical_value(feature.mean);
  return value > 0.0 && value < kDarkAlbedo ? kDarkAlbedo / value : 1.0;
}

}  // namespace

Result<CleanFeatures> clean_features(const SamplePool& pool, const CountImage& n,
                                     GuardCounts& guards) {
  FeatureImages raw;
  for (const FeatureLayer& layer : pool.recording().features()) {
    const double largest = layer.name == "depth" ? kLargestFeatureValue : kLargestFeature;
    SPOOL_ASSIGN(const FeatureStatistics feature,
                 feature_statistics(pool, n, layer, guards, largest));
    const double factor = brightening(feature);
    for (std::size_t c = 0; c < feature.mean.size(); ++c) {
      raw.value.push_back(to_float(feature.mean[c], factor));
      raw.variance.push_back(
          convolve(to_float(feature.variance[c], factor * factor), four_sigma_taps(1.0)));
    }
  }
  if (raw.value.size() > kMostFeatureChannels) {
    return fail(ErrorCode::kData,
                "{}: has {} channels of albedo, normal and depth; twin_guides takes {}",
                pool.recording().name(), raw.value.size(), kMostFeatureChannels);
  }
  return clean_features(std::move(raw));
}

CleanFeatures clean_features(FeatureImages raw) {
  if (raw.value.empty()) return {};
  const int width = raw.value[0].width(), height = raw.value[0].height();
  const auto images = [&] {
    return std::vector<Image<float>>(raw.value.size(), Image<float>(width, height));
  };
  FeatureImages clean{images(), images()};
  parallel_tiles(width, height, [&](const Rectangle& tile) {
    const Blend blend = feature_fit(tile, raw, {});
    for (std::size_t c = 0; c < raw.value.size(); ++c) {
      paste(blend.mean[c], tile, clean.value[c]);
      paste(blend.variance[c], tile, clean.variance[c]);
    }
  });
  return {std::move(raw.value), std::move(clean)};
}

}  // namespace spool
