// How twin_guides cleans features, and means under their weights, against the slow twins.
#include "lib/filters/twin_guides/feature_fit.h"

#include <gtest/gtest.h>

#include "tests/filters/feature_images.h"
#include "tests/support/sizes.h"

namespace spool {
namespace {

using testing::noisy_features;
using testing::to_double;
using testing::to_float;

void blend_agrees(int width, int height, std::size_t channels, const BlendOptions& options) {
  const FeatureImages f = noisy_features(width, height, channels);
  std::vector<Image<float>> values, variances;
  for (std::uint64_t i = 0; i < 3; ++i) {
    values.push_back(to_float(reference::noise_image(width, height, 30 + i)));
    Plane v = reference::noise_image(width, height, 40 + i);
    for (double& value : v.pixels())
      value *= value;
    variances.push_back(to_float(v));
  }
  const auto twin = reference::blend(to_double(values), to_double(variances), to_double(f.value),
                                     to_double(f.variance), static_cast<double>(options.tau),
                                     options.radius, options.sigma);
  // Two tiles, so that one of them has a neighbour.
  const int half = width / 2;
  for (const Rectangle& tile : {Rectangle{0, 0, half, height}, Rectangle{half, 0, width, height}}) {
    if (tile.empty()) continue;
    const Blend blend = feature_blend(
        tile, std::vector<const Image<float>*>{&values[0], &values[1], &values[2]},
        std::vector<const Image<float>*>{&variances[0], &variances[1], &variances[2]}, f, options);
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        for (std::size_t i = 0; i < 3; ++i) {
          ASSERT_NEAR(blend.mean[i](x - tile.x0, y), twin.mean[i](x, y), 2e-6);
          ASSERT_NEAR(blend.variance[i](x - tile.x0, y), twin.variance[i](x, y), 2e-6);
        }
      }
    }
  }
}

void feature_fit_agrees(int width, int height, std::size_t channels,
                        const FeatureFitOptions& options) {
  const FeatureImages f = noisy_features(width, height, channels);
  const auto wide = [](float value) { return static_cast<double>(value); };
  const auto twin =
      reference::feature_fit(to_double(f.value), to_double(f.variance),
                             {wide(options.tau), wide(options.slack), wide(options.gain),
                              options.patch, options.radius, options.sigma, wide(options.ridge)});
  const int half = width / 2;  // two tiles, so that one of them has a neighbour
  for (const Rectangle& tile : {Rectangle{0, 0, half, height}, Rectangle{half, 0, width, height}}) {
    if (tile.empty()) continue;
    const Blend fitted = feature_fit(tile, f, options);
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        for (std::size_t c = 0; c < channels; ++c) {
          ASSERT_NEAR(fitted.mean[c](x - tile.x0, y), twin.mean[c](x, y), 1e-5);
          ASSERT_NEAR(fitted.variance[c](x - tile.x0, y), twin.variance[c](x, y), 2e-6);
        }
      }
    }
  }
}

TEST(TwinGuidesDifferential, FeaturesCleanedByLines) {
  for (const auto& [width, height] : test::twin_sizes())
    feature_fit_agrees(width, height, 7, {});
  feature_fit_agrees(43, 21, 3, {1e-2f, 1.0f, 5.0f, 2, 3, 1.5, 0.1f});
  feature_fit_agrees(20, 31, 1, {1e-3f, 3.0f, 3.0f, 0, 4, 4.0, 0.01f});
}

TEST(TwinGuidesDifferential, MeansUnderTheFeaturesWeights) {
  for (const auto& [width, height] : test::twin_sizes()) {
    blend_agrees(width, height, 7, {1e-3f, 5, 4.0});
    blend_agrees(width, height, 1, {1e-2f, 2, 0.7});
    blend_agrees(width, height, 0, {1e-2f, 2, 0.7});
  }
  blend_agrees(43, 21, 3, {1e-3f, 3, 1.5});
}

}  // namespace
}  // namespace spool
