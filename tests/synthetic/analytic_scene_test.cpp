#include "lib/synthetic/analytic_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "lib/core/parallel.h"
#include "lib/synthetic/pixel_quadrature.h"
#include "lib/synthetic/scene_s.h"
#include "lib/synthetic/synthetic_scenes.h"

namespace spool {
namespace {

struct PixelSample {
  double mean = 0, variance = 0;
};

PixelSample sampled(const AnalyticScene& scene, int x, int y, int n, std::uint64_t seed) {
  double mean = 0, m2 = 0;
  for (int s = 0; s < n; ++s) {
    const double value = synthetic_sample(scene, seed, x, y, s).radiance[1];
    const double delta = value - mean;
    mean += delta / (s + 1);
    m2 += delta * (value - mean);
  }
  return {mean, m2 / (n - 1)};
}

// z-score of the mean of `values` against `expected`.
double z_score(const std::vector<double>& values, double expected) {
  double mean = 0, m2 = 0, n = 0;
  for (const double v : values) {
    ++n;
    const double delta = v - mean;
    mean += delta / n;
    m2 += delta * (v - mean);
  }
  return (mean - expected) / std::sqrt(m2 / (n - 1) / n);
}

// Sampled means agree with the exact ones: the standardised squared errors average to 1 and the
// standardised errors to 0; sampled variances agree with the exact ones on average. Each within 4
// standard errors (significance about 6e-5 each).
void expect_exact_moments(const AnalyticScene& scene, int n) {
  std::vector<double> error, squared, variance_ratio;
  for (int y = 0; y < scene.height; ++y) {
    for (int x = 0; x < scene.width; ++x) {
      const Moments exact = scene.moments(x, y);
      const PixelSample found = sampled(scene, x, y, n, 99);
      if (exact.variance() < 1e-12 * exact.second + 1e-300) {
        // The samples are float.
        EXPECT_NEAR(found.mean, exact.first, 1e-7 * std::abs(exact.first)) << x << "," << y;
        continue;
      }
      const double z = (found.mean - exact.first) / std::sqrt(exact.variance() / n);
      error.push_back(z);
      squared.push_back(z * z);
      variance_ratio.push_back(found.variance / exact.variance());
      EXPECT_LT(std::abs(z), 7.0) << scene.name << " at " << x << "," << y;
    }
  }
  if (error.size() < 20) return;  // too few pixels for tests of averages
  EXPECT_LT(std::abs(z_score(error, 0.0)), 4.0) << scene.name;
  EXPECT_LT(std::abs(z_score(squared, 1.0)), 4.0) << scene.name;
  EXPECT_LT(std::abs(z_score(variance_ratio, 1.0)), 4.0) << scene.name;
}

TEST(SceneS, SampledMeansAndVariancesAgreeWithTheExactOnes) {
  expect_exact_moments(scene_s(64, 64), 400);
  expect_exact_moments(scene_s(64, 64, {true, 0.1, 5.0}), 400);
}

TEST(SceneS, IsExactAtAnySizeAlsoWhereStreakShadowAndCheckerMeet) {
  expect_exact_moments(scene_s(1, 1), 20000);
  expect_exact_moments(scene_s(1, 9), 4000);
  expect_exact_moments(scene_s(17, 16), 2000);
  expect_exact_moments(scene_s(31, 20), 1000);
  expect_exact_moments(scene_s(60, 12), 3000);  // the streak crosses both
}

TEST(SceneS, HasABlackCornerAndAFirefliesPatchOnlyWhenAsked) {
  const AnalyticScene quiet = scene_s(64, 64), loud = scene_s(64, 64, {true, 0.004, 25.0});
  EXPECT_EQ(quiet.moments(63, 63).second, 0.0);
  EXPECT_NEAR(loud.moments(40, 55).first - quiet.moments(40, 55).first, 0.004 * 25.0, 1e-12);
}

TEST(SyntheticScenes, SampledMeansAndVariancesAgreeWithTheExactOnes) {
  for (const SyntheticEntry& entry : synthetic_scenes()) {
    if (entry.name == "heavy_tail" || entry.name == "not_finite") continue;
    SyntheticOptions options;
    options.odds = 0.1;  // the default would need more samples for the same test
    auto scene = synthetic_scene(entry.name, 24, 20, options);
    ASSERT_TRUE(scene.has_value());
    expect_exact_moments(*scene, 400);
  }
}

TEST(SyntheticScenes, AreExactInTallPicturesAndWithPeriodsFarBelowAPixel) {
  expect_exact_moments(*synthetic_scene("zone_plate", 3, 200), 400);
  expect_exact_moments(*synthetic_scene("zone_plate", 200, 3), 400);
  for (const char* name : {"streaks", "fine_checker"}) {
    for (const double period : {1e-3, 3e-3, 0.037, 0.4}) {
      SyntheticOptions options;
      options.period = period;
      for (const double angle : {0.0, 30.0, 90.0}) {
        options.angle = angle;
        expect_exact_moments(*synthetic_scene(name, 24, 20, options), 400);
      }
    }
  }
}

TEST(SyntheticScenes, StreaksHaveTheMeanOfTheirCosine) {
  SyntheticOptions options;
  const AnalyticScene scene = *synthetic_scene("streaks", 24, 20, options);
  const double angle = options.angle * std::numbers::pi / 180.0;
  for (const auto& [x, y] : {std::pair{0, 0}, {5, 17}, {23, 2}}) {
    const Moments whole = pixel_mean(x, y, {}, [&](double px, double py) -> Moments {
      const double across = 2.0 * std::numbers::pi / (20.0 * options.period);
      const double odds =
          0.5 + 0.45 * std::cos(across * (py * std::cos(angle) - px * std::sin(angle)));
      return {0.1 + odds, 0.01 + 1.2 * odds};
    });
    EXPECT_NEAR(scene.moments(x, y).first, whole.first, 1e-14);
    EXPECT_NEAR(scene.moments(x, y).second, whole.second, 1e-14);
  }
}

TEST(SyntheticScenes, HeavyTailHasTheQuantilesOfPareto) {
  const AnalyticScene scene = *synthetic_scene("heavy_tail", 50, 50);
  EXPECT_TRUE(std::isinf(scene.moments(0, 0).second));
  EXPECT_DOUBLE_EQ(scene.moments(0, 0).first, 3.0);
  int below_median = 0, below_99 = 0;
  const int n = 2500 * 8;
  for (int i = 0; i < n; ++i) {
    const double v = synthetic_sample(scene, 5, i % 50, i / 50 % 50, i / 2500).radiance[0];
    below_median += v < std::pow(2.0, 1 / 1.5);
    below_99 += v < std::pow(100.0, 1 / 1.5);
  }
  EXPECT_NEAR(below_median, 0.5 * n, 4 * std::sqrt(0.25 * n));
  EXPECT_NEAR(below_99, 0.99 * n, 4 * std::sqrt(0.0099 * n));
}

TEST(SyntheticScenes, NotFiniteHasItsShareOfBadSamples) {
  SyntheticOptions options;
  options.odds = 0.05;
  const AnalyticScene scene = *synthetic_scene("not_finite", 50, 50, options);
  SanitiseRules rules;
  rules.allow_many_rejected = true;
  const RecordedSamples recording = make_recording(scene, 8, 3, rules);
  EXPECT_NEAR(static_cast<double>(recording.report().nonfinite), 0.05 * 20000,
              4 * std::sqrt(0.05 * 0.95 * 20000));
}

TEST(SyntheticScenes, UnknownNameSaysTheNearest) {
  const auto scene = synthetic_scene("zone_plat", 8, 8);
  ASSERT_FALSE(scene.has_value());
  EXPECT_EQ(scene.error().code, ErrorCode::kUsage);
  EXPECT_NE(scene.error().message.find("zone_plate"), std::string::npos);
  EXPECT_FALSE(synthetic_scene("disc", 0, 8).has_value());
}

TEST(MakeRecording, CarriesFilmPositionsAndTheExactReference) {
  const AnalyticScene scene = scene_s(20, 12);
  const RecordedSamples recording = make_scene_s(20, 12, 5, 42);
  EXPECT_TRUE(recording.exchangeable());
  ASSERT_TRUE(recording.has_film());
  ASSERT_TRUE(recording.reference().has_value());
  EXPECT_FALSE(recording.reference()->variance_of_mean.has_value());
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 20; ++x) {
      EXPECT_EQ(recording.reference()->mean[2](x, y), scene.moments(x, y).first);
      for (int s = 0; s < 5; ++s) {
        const SyntheticSample sample = synthetic_sample(scene, 42, x, y, s);
        EXPECT_EQ(recording.radiance(x, y, s), sample.radiance);
        EXPECT_EQ(recording.film(x, y, s).x, sample.film.x);
        EXPECT_GE(sample.film.x, 0.0f);
        EXPECT_LT(sample.film.y, 1.0f);
      }
    }
  }
}

TEST(MakeRecording, BitsDoNotDependOnTheNumberOfThreads) {
  const auto bits = [](int threads) {
    const ThreadLimit limit(threads);
    const RecordedSamples recording = make_scene_s(33, 21, 4, 7);
    std::vector<double> values;
    for (int i = 0; i < 33 * 21 * 4; ++i) {
      values.push_back(recording.radiance(i % 33, i / 33 % 21, i / 693)[0]);
      values.push_back(recording.reference()->mean[0](i % 33, i / 33 % 21));
    }
    return values;
  };
  const auto once = bits(1);
  EXPECT_EQ(bits(2), once);
  EXPECT_EQ(bits(7), once);
}

}  // namespace
}  // namespace spool
