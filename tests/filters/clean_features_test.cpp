#include "lib/filters/twin_guides/clean_features.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace spool {
namespace {

constexpr int kWidth = 40, kHeight = 28;

// An edge out of focus is a ramp of noisy features: it must come out as a ramp.
TEST(CleanFeatures, ARampIsFollowedAndLosesItsNoise) {
  constexpr float kNoise = 0.1f;
  FeatureImages raw{{Image<float>(kWidth, kHeight)}, {Image<float>(kWidth, kHeight)}};
  double before = 0.0, after = 0.0;
  const auto ramp = [](int x, int y) {
    return 0.04f * static_cast<float>(x) - 0.02f * static_cast<float>(y);
  };
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float noise =
          kNoise * static_cast<float>((x * 7 + y * 13 + x * y * 3) % 11 - 5) / std::sqrt(10.0f);
      raw.value[0](x, y) = ramp(x, y) + noise;
      raw.variance[0](x, y) = kNoise * kNoise;
      before += noise * noise;
    }
  }
  const CleanFeatures features = clean_features(std::move(raw));
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x)
      after += std::pow(features.clean.value[0](x, y) - ramp(x, y), 2);
  }
  EXPECT_LT(after, 0.15 * before);  // a mean under the same weights leaves 0.21
}

}  // namespace
}  // namespace spool
