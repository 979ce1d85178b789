#include "lib/filters/twin_guides/clean_features.h"

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

}  // namespace

Result<CleanFeatures> clean_features(const SamplePool& pool, const CountImage& n,
                                     GuardCounts& guards) {
  FeatureImages raw;
  for (const FeatureLayer& layer : pool.recording().features()) {
    const double largest = layer.name == "depth" ? kLargestFeatureValue : kLargestFeature;
    SPOOL_ASSIGN(const FeatureStatistics feature,
                 feature_statistics(pool, n, layer, guards, largest));
    for (std::size_t c = 0; c < feature.mean.size(); ++c) {
      raw.value.push_back(to_float(feature.mean[c]));
      raw.variance.push_back(convolve(to_float(feature.variance[c]), four_sigma_taps(1.0)));
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
