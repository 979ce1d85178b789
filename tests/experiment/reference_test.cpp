#include "lib/experiment/reference.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "lib/core/random.h"
#include "lib/statistics/piece_statistics.h"
#include "lib/synthetic/scene_s.h"
#include "tests/support/memory_pool.h"
#include "tests/support/random_images.h"

namespace spool {
namespace {

using test::memory_recording;
using test::pool_of;

// The three pools of the bias study: mean and variance of one sample are known.
struct Distribution {
  std::string name;
  double mean, variance;
  std::function<double(double u, double v)> sample;
};

const std::vector<Distribution>& distributions() {
  static const std::vector<Distribution> all = {
      {"uniform", 0.5, 1.0 / 12, [](double u, double) { return u; }},
      {"lognormal", 1.0, std::exp(1.0) - 1.0,
       [](double u, double v) {
         const double normal =
             std::sqrt(-2.0 * std::log(1.0 - u)) * std::cos(2.0 * std::numbers::pi * v);
         return std::exp(normal - 0.5);
       }},
      {"bernoulli", 1.0, 19.0, [](double u, double) { return u < 0.05 ? 20.0 : 0.0; }},
  };
  return all;
}

constexpr int kSide = 120, kSpp = 64;

SamplePool pool_from(const Distribution& distribution, int holdout = 0, std::uint64_t seed = 1) {
  PoolOptions options;
  options.holdout = holdout;
  const auto radiance = [&](int x, int y, int s) -> Rgb {
    Rgb rgb{};
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint64_t word = mix(seed, x, y, s, c);
      rgb[c] = static_cast<float>(
          distribution.sample(unit_double(mix(word, 0)), unit_double(mix(word, 1))));
    }
    return rgb;
  };
  return pool_of(memory_recording(kSide, kSide, kSpp, radiance), options);
}

// A sampler whose counts depend on what it saw: 4 samples, then 24 more where their contrast is
// high, then 24 more where the mean still varies by more than itself.
CountImage adaptive_counts(const SamplePool& pool) {
  CountImage counts(pool.width(), pool.height());
  for (int y = 0; y < pool.height(); ++y) {
    for (int x = 0; x < pool.width(); ++x) {
      const auto spread = [&](int n) {
        double low = 1e300, high = -1e300, sum = 0.0, squares = 0.0;
        for (int i = 0; i < n; ++i) {
          const double v = pool.sample(x, y, i)[0];
          low = std::min(low, v), high = std::max(high, v);
          sum += v, squares += v * v;
        }
        const double mean = sum / n;
        return std::pair{(high - low) / std::max(high + low, 1e-12),
                         std::sqrt(squares / n - mean * mean) / std::max(mean, 1e-9)};
      };
      int n = 4;
      if (spread(4).first > 0.5) n = 28;
      if (n == 28 && spread(28).second > 1.0) n = 52;
      counts(x, y) = std::min(n, pool.capacity(x, y));
    }
  }
  return counts;
}

RgbImage estimate_of(const SamplePool& pool, const CountImage& counts) {
  GuardCounts guards;
  return pixel_means(prefix_statistics(pool, counts), guards);
}

struct Difference {
  double mean = 0, standard_error = 0;
};

// What `reference` finds minus the true squared error, over pixels and channels.
Difference excess(const RgbImage& estimate, const JudgingReference& reference, double truth) {
  double mean = 0, m2 = 0, n = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t p = 0; p < estimate[c].size(); ++p) {
      const double found =
          (estimate[c][p] - reference.mean[c][p]) * (estimate[c][p] - reference.mean[c][p]) -
          (reference.variance ? (*reference.variance)[c][p] : 0.0);
      const double v = found - (estimate[c][p] - truth) * (estimate[c][p] - truth);
      ++n;
      const double delta = v - mean;
      mean += delta / n;
      m2 += delta * (v - mean);
    }
  }
  return {mean, std::sqrt(m2 / (n - 1) / n)};
}

// 4 standard errors: significance 6e-5 for each pool.
TEST(LeaveSelectedOut, IsUnbiasedForFixedCounts) {
  for (const Distribution& d : distributions()) {
    const SamplePool pool = pool_from(d);
    const CountImage counts(kSide, kSide, 16);
    const RgbImage estimate = estimate_of(pool, counts);
    const Difference found = excess(estimate, leave_selected_out_reference(pool, counts), d.mean);
    EXPECT_LT(std::abs(found.mean), 4 * found.standard_error) << d.name;
    EXPECT_LT(found.standard_error, 0.03 * d.variance / 16) << d.name;  // a test worth having
  }
}

TEST(LeaveSelectedOut, IsUnbiasedWhenTheCountsDependOnTheSamples) {
  for (const Distribution& d : distributions()) {
    const SamplePool pool = pool_from(d);
    const CountImage counts = adaptive_counts(pool);
    const RgbImage estimate = estimate_of(pool, counts);
    const Difference found = excess(estimate, leave_selected_out_reference(pool, counts), d.mean);
    EXPECT_LT(std::abs(found.mean), 4 * found.standard_error) << d.name;
  }
}

TEST(HoldoutReference, IsUnbiasedForFixedAndForAdaptiveCounts) {
  for (const Distribution& d : distributions()) {
    const SamplePool pool = pool_from(d, 16);
    const auto reference = holdout_reference(pool);
    ASSERT_TRUE(reference.has_value());
    for (const CountImage& counts : {CountImage(kSide, kSide, 16), adaptive_counts(pool)}) {
      const Difference found = excess(estimate_of(pool, counts), *reference, d.mean);
      EXPECT_LT(std::abs(found.mean), 4 * found.standard_error) << d.name;
    }
  }
}

TEST(HoldoutPair, IsUnbiasedForFixedAndForAdaptiveCounts) {
  for (const Distribution& d : distributions()) {
    const SamplePool pool = pool_from(d, 16);
    const auto reference = holdout_pair_reference(pool);
    ASSERT_TRUE(reference.has_value());
    for (const CountImage& counts : {CountImage(kSide, kSide, 16), adaptive_counts(pool)}) {
      const Difference found = excess(estimate_of(pool, counts), *reference, d.mean);
      EXPECT_LT(std::abs(found.mean), 4 * found.standard_error) << d.name;
    }
  }
}

// A filtered estimate mixes neighbours, which contribute selected samples only.
TEST(LeaveSelectedOut, IsUnbiasedForFilteredEstimates) {
  const Distribution& d = distributions()[2];
  const SamplePool pool = pool_from(d);
  const CountImage counts = adaptive_counts(pool);
  RgbImage estimate = estimate_of(pool, counts);
  for (Plane& plane : estimate)
    plane = box_mean_3x3(plane);
  const Difference found = excess(estimate, leave_selected_out_reference(pool, counts), d.mean);
  EXPECT_LT(std::abs(found.mean), 4 * found.standard_error);
}

// The pool's own mean finds (s2 / n)(1 - n / N).
TEST(PoolReference, FindsTheErrorTimesOneMinusNOverN) {
  MetricOptions options;
  options.perceptual = Perceptual::kNone;
  for (const Distribution& d : distributions()) {
    const SamplePool pool = pool_from(d);
    const JudgingReference reference = pool_reference(pool);
    EXPECT_FALSE(reference.variance.has_value());
    for (const int n : {16, 48, 64}) {
      const CountImage counts(kSide, kSide, n);
      const double measured =
          error_metrics(estimate_of(pool, counts), reference, options)["mse"].value /
          (d.variance / n);
      // Relative standard error of a mean of 43200 squares of near-normal numbers, and more for
      // the heavier tails: 0.03 covers 4 of them in each pool.
      EXPECT_NEAR(measured, 1.0 - n / 64.0, 0.03) << d.name << " " << n;
    }
  }
}

TEST(Reference, PoolIsFlaggedAsBiasedAndNoOtherIs) {
  for (const ReferenceDescription& kind : reference_kinds()) {
    EXPECT_EQ(kind.biased, kind.kind == ReferenceKind::kPool);
    EXPECT_EQ(is_biased(kind.kind), kind.biased);
    EXPECT_EQ(*parse_reference_kind(kind.name), kind.kind);
    EXPECT_EQ(reference_name(kind.kind), kind.name);
  }
  const auto unknown = parse_reference_kind("hold_out");
  ASSERT_FALSE(unknown.has_value());
  EXPECT_NE(unknown.error().message.find("holdout"), std::string::npos);
}

TEST(HoldoutReference, UsesTwoThirdsForTheMeanAndTheRestForTheDenominator) {
  PoolOptions options;
  options.holdout = 7;
  const SamplePool pool = pool_of(memory_recording(1, 1, 10,
                                                   [](int, int, int s) -> Rgb {
                                                     const auto v = static_cast<float>(s);
                                                     return {v, 2 * v, 0.0f};
                                                   }),
                                  options);
  const auto reference = holdout_reference(pool);
  ASSERT_TRUE(reference.has_value());
  // Held out: 3 .. 9. R from 3 .. 7: mean 5, variance 2.5 / 5; D from 8, 9.
  EXPECT_DOUBLE_EQ(reference->mean[0](0, 0), 5.0);
  EXPECT_DOUBLE_EQ(reference->mean[1](0, 0), 10.0);
  EXPECT_DOUBLE_EQ((*reference->variance)[0](0, 0), 0.5);
  EXPECT_DOUBLE_EQ((*reference->denominator)[0](0, 0), 8.5);
}

// Held out: 3 .. 9; the pair are the means of 3, 5, 7 and of 4, 6.
TEST(HoldoutPair, IsTheProductOfTheErrorsAgainstTwoMeans) {
  PoolOptions options;
  options.holdout = 7;
  const SamplePool pool = pool_of(memory_recording(1, 1, 10,
                                                   [](int, int, int s) -> Rgb {
                                                     const auto v = static_cast<float>(s);
                                                     return {v, v * v, 0.0f};
                                                   }),
                                  options);
  const auto reference = holdout_pair_reference(pool);
  ASSERT_TRUE(reference.has_value());
  const auto error_of = [&](double estimate, std::size_t c) {
    const double difference = estimate - reference->mean[c](0, 0);
    return difference * difference - (*reference->variance)[c](0, 0);
  };
  EXPECT_DOUBLE_EQ(error_of(2.0, 0), (2.0 - 5.0) * (2.0 - 5.0));
  EXPECT_DOUBLE_EQ(error_of(1.0, 1), (1.0 - 83.0 / 3) * (1.0 - 26.0));
  EXPECT_DOUBLE_EQ((*reference->denominator)[0](0, 0), 8.5);
  options.holdout = 4;
  const SamplePool few =
      pool_of(memory_recording(1, 1, 10, [](int, int, int) -> Rgb { return {}; }), options);
  EXPECT_EQ(holdout_pair_reference(few).error().code, ErrorCode::kData);
}

TEST(HoldoutReference, IsRefusedWithoutEnoughSamples) {
  PoolOptions options;
  options.holdout = 2;
  const SamplePool pool =
      pool_of(memory_recording(1, 1, 10, [](int, int, int) -> Rgb { return {}; }), options);
  const auto reference = holdout_reference(pool);
  ASSERT_FALSE(reference.has_value());
  EXPECT_EQ(reference.error().code, ErrorCode::kData);
}

TEST(LeaveSelectedOut, PixelsWithoutTwoSamplesLeftHaveNoReference) {
  const SamplePool pool = pool_from(distributions()[0]);
  CountImage counts(kSide, kSide, 8);
  counts(3, 3) = 64;
  counts(4, 3) = 63;
  const JudgingReference reference = leave_selected_out_reference(pool, counts);
  EXPECT_TRUE(std::isnan(reference.mean[0](3, 3)));
  EXPECT_TRUE(std::isnan(reference.mean[0](4, 3)));
  EXPECT_TRUE(std::isfinite(reference.mean[0](5, 3)));
  const MetricTable table = error_metrics(estimate_of(pool, counts), reference);
  EXPECT_EQ(table.excluded_reference, 2u);
  EXPECT_FALSE(table.failed);
}

// Quarter pixels: the reference of a pixel is the mean of its four pieces and remains unbiased.
TEST(LeaveSelectedOut, IsUnbiasedForQuarterPixels) {
  const AnalyticScene scene = scene_s(48, 48);
  PoolOptions options;
  options.pieces_per_side = 2;
  options.holdout = 24;
  const SamplePool pool =
      pool_of(std::make_shared<const RecordedSamples>(make_recording(scene, 80, 11)), options);
  CountImage counts(96, 96);
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 96; ++x)
      counts(x, y) = std::min(2, pool.capacity(x, y));
  }
  const RgbImage estimate = estimate_of(pool, counts);
  const ExactImage exact = exact_image(scene);
  for (const JudgingReference& reference :
       {leave_selected_out_reference(pool, counts), *holdout_reference(pool)}) {
    std::vector<double> excess_of_pixels;
    for (std::size_t p = 0; p < estimate[0].size(); ++p) {
      const double e = estimate[0][p], r = reference.mean[0][p], t = exact.mean[0][p];
      if (!std::isfinite(r)) continue;
      excess_of_pixels.push_back((e - r) * (e - r) - (*reference.variance)[0][p] -
                                 (e - t) * (e - t));
    }
    EXPECT_GT(excess_of_pixels.size(), 2200u);
    double mean = 0, m2 = 0, n = 0;
    for (const double v : excess_of_pixels) {
      ++n;
      const double delta = v - mean;
      mean += delta / n;
      m2 += delta * (v - mean);
    }
    EXPECT_LT(std::abs(mean), 4 * std::sqrt(m2 / (n - 1) / n));
  }
}

TEST(Reference, DefaultsFollowWhatTheRecordingHas) {
  const auto grey = [](int, int, int) -> Rgb { return {1.0f, 1.0f, 1.0f}; };
  EXPECT_EQ(default_holdout(31), 0);
  EXPECT_EQ(default_holdout(32), 16);
  EXPECT_EQ(default_holdout(256), 64);
  EXPECT_EQ(default_reference_kind(8, false), ReferenceKind::kLeaveSelectedOut);
  const auto withheld = [](ReferenceKind kind, std::optional<int> chosen, int pieces) {
    return withheld_samples(kind, 64, chosen, pieces);
  };
  EXPECT_EQ(withheld(ReferenceKind::kHoldout, {}, 2), 16);
  EXPECT_EQ(withheld(ReferenceKind::kHoldoutPair, 5, 1), 5);
  EXPECT_EQ(withheld(ReferenceKind::kIndependent, {}, 1), 0);
  EXPECT_EQ(withheld(ReferenceKind::kLeaveSelectedOut, {}, 1), 3);
  EXPECT_EQ(withheld(ReferenceKind::kLeaveSelectedOut, 4, 2), 12);
  EXPECT_EQ(withheld(ReferenceKind::kLeaveSelectedOut, 16, 2), 16);
  for (const int spp : {1, 3})
    EXPECT_EQ(withheld_samples(ReferenceKind::kLeaveSelectedOut, spp, {}, 1), spp - 1);
  EXPECT_EQ(offered_samples(ReferenceKind::kIndependent, 64, {}, 1), 64);
  EXPECT_EQ(offered_samples(ReferenceKind::kHoldout, 64, {}, 1), 48);
  EXPECT_EQ(offered_samples(ReferenceKind::kLeaveSelectedOut, 64, {}, 2), 52);
  EXPECT_EQ(offered_samples(ReferenceKind::kCrossfit, 64, {}, 1), 32);
  EXPECT_EQ(default_reference_kind(64, false), ReferenceKind::kHoldout);
  EXPECT_EQ(default_reference_kind(64, true), ReferenceKind::kIndependent);
  EXPECT_FALSE(independent_reference(*memory_recording(2, 2, 8, grey)).has_value());
}

// Samples of noise, judged by the mean of the first `of` samples of each pixel, rounded to float.
bool judges(int of, int side, int spp, const std::function<float(int, int, int)>& radiance) {
  RecordedSamples recording = *memory_recording(side, side, spp, [&](int x, int y, int s) -> Rgb {
    const float v = radiance(x, y, s);
    return {v, v, v};
  });
  RgbImage mean = make_rgb(side, side);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      double sum = 0;
      for (int s = 0; s < of; ++s)
        sum += static_cast<double>(radiance(x, y, s));
      for (Plane& plane : mean)
        plane(x, y) = static_cast<double>(static_cast<float>(sum / of));
    }
  }
  recording.set_reference({mean, {}});
  return independent_reference(recording).has_value();
}

TEST(Reference, TheMeanOfTheSamplesThemselvesDoesNotJudge) {
  const auto noise = [](int x, int y, int s) {
    return static_cast<float>(-std::log1p(-unit_double(mix(1, x, y, s))));
  };
  EXPECT_FALSE(judges(16, 16, 16, noise));
  EXPECT_FALSE(judges(256, 64, 256, noise));  // more samples than are looked at
  EXPECT_TRUE(judges(15, 16, 16, noise));
  EXPECT_TRUE(judges(1, 16, 16, noise));
  // A lamp, a sky: without noise the two are one anyway.
  EXPECT_TRUE(judges(16, 16, 16, [](int x, int y, int) {
    return 0.1f * static_cast<float>(x) + static_cast<float>(y);
  }));
  EXPECT_TRUE(judges(4, 2, 4, noise));  // too few values to say so
}

// A noisy independent reference: the debiased value is that of the noiseless one on average.
TEST(ErrorMetrics, DebiasingIsUnbiased) {
  std::vector<double> found;
  const RgbImage truth = make_rgb(32, 32, 1.0);
  const RgbImage estimate = test::add_noise(truth, 3, 0.1);
  MetricOptions options;
  options.bootstrap.resamples = 0;
  options.perceptual = Perceptual::kNone;
  const double exact = error_metrics(estimate, {truth, {}, {}}, options)["mse"].value;
  double mean = 0, m2 = 0;
  for (int trial = 1; trial <= 400; ++trial) {
    const JudgingReference noisy{
        test::add_noise(truth, 1000 + trial, 0.2), make_rgb(32, 32, 0.04), {}};
    const double delta = error_metrics(estimate, noisy, options)["mse"].value - mean;
    mean += delta / trial;
    m2 += delta * (delta - delta / trial);
  }
  EXPECT_LT(std::abs(mean - exact), 4 * std::sqrt(m2 / 399 / 400));
}

TEST(BoxMean, ClipsAtTheBorderAndSkipsHoles) {
  Plane image(3, 3, 1.0);
  image(0, 0) = 4.0;
  image(2, 2) = std::nan("");
  const Plane mean = box_mean_3x3(image);
  EXPECT_DOUBLE_EQ(mean(0, 0), 7.0 / 4);
  EXPECT_DOUBLE_EQ(mean(1, 1), 11.0 / 8);
  EXPECT_DOUBLE_EQ(mean(2, 2), 1.0);
}

}  // namespace
}  // namespace spool
