// Counts applied to samples that had no say.
#include "lib/experiment/fresh_samples.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/memory_pool.h"

namespace spool {
namespace {

constexpr int kSide = 48, kSamples = 64;

// Rare bright events: 20 with probability 0.05, mean 1, everywhere alike.
SamplePool rare_events(std::uint64_t seed) {
  return test::pool_of(test::memory_recording(kSide, kSide, kSamples, [=](int x, int y, int s) {
    const float value = unit_double(mix(seed, x, y, s)) < 0.05 ? 20.0f : 0.0f;
    return Rgb{value, value, value};
  }));
}

// Four samples everywhere, and eight more where one of them was bright.
Result<Selection> look_again_at_the_bright(const SamplePool& pool, std::size_t) {
  CountImage n(pool.width(), pool.height());
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x) {
      n(x, y) = 4;
      for (int i = 0; i < 4; ++i)
        n(x, y) = pool.sample(x, y, i)[0] > 0.0f ? 12 : n(x, y);
    }
  }
  return Selection{prefix_statistics(pool, n), {}};
}

Result<RgbImage> box(const Selection& selection, const SamplePool&) {
  GuardCounts guards;
  return pixel_means(selection.statistics, guards);
}

JudgingReference truth() {
  return {make_rgb(kSide, kSide, 1.0), std::nullopt, std::nullopt};
}

// What a replicate with the whole pool would have taken.
CountImage taken() {
  return CountImage(kSide, kSide, 6);
}

double mean_of(const RgbImage& image) {
  double sum = 0.0;
  for (const double v : image[0].pixels())
    sum += v;
  return sum / static_cast<double>(image[0].size());
}

TEST(FreshSamples, KeepTheEnergyThatOwnSamplesLose) {
  double fresh = 0.0, own = 0.0, bias2 = 0.0, variance = 0.0;
  constexpr int kRuns = 20;
  for (int r = 0; r < kRuns; ++r) {
    const SamplePool pool = rare_events(static_cast<std::uint64_t>(r));
    const auto halves = select_halves(pool, kSide * kSide * 6, true, look_again_at_the_bright);
    ASSERT_TRUE(halves.has_value() && halves->has_value());
    const auto judged = judge_halves(pool, **halves, taken(), truth(), {}, box);
    ASSERT_TRUE(judged.has_value());
    const auto& errors = judged->fresh;
    fresh += errors->energy_ratio / kRuns;
    bias2 += errors->parts.bias2 / kRuns;
    variance += errors->parts.variance / kRuns;
    for (std::size_t h = 0; h < 2; ++h)
      own += 0.5 * mean_of(*box((*halves)->own[h], pool)) / kRuns;
  }
  // p = 0.95^4 of the pixels are black: 4 samples of mean 0. The others hold 4 samples of mean
  // 1 / (1 - p) and 8 of mean 1.
  const double p = std::pow(0.95, 4.0), bright = (1.0 / (1.0 - p) + 2.0) / 3.0;
  const double expected = (1.0 - p) * bright;
  // Standard deviation of a pixel about 1.8: of the mean of 20 * 2 * 48 * 48 pixels 0.006.
  EXPECT_NEAR(own, expected, 0.03);
  EXPECT_LT(expected, 0.5);
  EXPECT_NEAR(fresh, 1.0, 0.03);
  EXPECT_NEAR(bias2, (1.0 - expected) * (1.0 - expected), 0.05);
  EXPECT_GT(variance, 0.1);
}

TEST(FreshSamples, NoSampleDecidesAboutItsOwnCount) {
  const SamplePool pool = rare_events(1);
  const auto halves = select_halves(pool, 1000, true, look_again_at_the_bright);
  for (int h = 0; h < 2; ++h) {
    const auto at = static_cast<std::size_t>(h);
    const CountImage own = look_again_at_the_bright(pool.half(h), 0)->statistics.n;
    EXPECT_EQ((*halves)->own[at].statistics.n, own);
    EXPECT_EQ((*(*halves)->fresh)[1 - at].statistics.n, own);
    EXPECT_EQ((*(*halves)->fresh)[1 - at].statistics.mean,
              prefix_statistics(pool.half(1 - h), own).mean);
  }
  // Sample 2 (n - 1) + h of the pool is the last of n that a half has shown.
  const CountImage n = looked_at(pool, **halves);
  for (std::size_t i = 0; i < n.size(); ++i) {
    const int most = std::max((*halves)->own[0].statistics.n[i], (*halves)->own[1].statistics.n[i]);
    ASSERT_EQ(n[i], 2 * most);
  }
}

TEST(FreshSamples, OfUniformCountsHaveTheSameError) {
  const SamplePool pool = rare_events(2);
  const auto uniform = [](const SamplePool& half, std::size_t) -> Result<Selection> {
    return Selection{prefix_statistics(half, CountImage(kSide, kSide, 8)), {}};
  };
  const auto halves = select_halves(pool, kSide * kSide * 8, true, uniform);
  const auto judged = judge_halves(pool, **halves, taken(), truth(), {}, box);
  const auto& errors = judged->fresh;
  EXPECT_EQ(errors->mse, errors->parts.bias2 + errors->parts.variance);
  EXPECT_EQ(errors->saturated_share, 0.0);
  EXPECT_NEAR(errors->parts.variance, 19.0 / 8.0, 0.25);
  EXPECT_NEAR(errors->parts.bias2, 0.0, 0.15);
}

const HalfDifference& difference_named(const HalfErrors& errors, const std::string& metric) {
  const auto found = std::ranges::find(errors.differences, metric,
                                       [](const auto& halves) { return halves.metric; });
  EXPECT_NE(found, errors.differences.end()) << metric;
  return found->difference;
}

// Fails where a half holds samples of the other: then the two images are alike.
TEST(FreshSamples, DifferencesOfHalvesHaveTheVarianceBetweenRecordings) {
  const auto uniform = [](const SamplePool& half, std::size_t) -> Result<Selection> {
    return Selection{prefix_statistics(half, CountImage(kSide, kSide, 8)), {}};
  };
  double between = 0.0, sum = 0.0, squares = 0.0;
  constexpr int kRuns = 60;
  for (int r = 0; r < kRuns; ++r) {
    const SamplePool pool = rare_events(static_cast<std::uint64_t>(100 + r));
    const auto halves = select_halves(pool, kSide * kSide * 8, false, uniform);
    const auto judged = judge_halves(pool, **halves, taken(), truth(), {}, box);
    EXPECT_FALSE(judged->fresh.has_value());
    const HalfDifference& mse = difference_named(*judged, "mse");
    between += half_variance(std::vector{mse}).variance / kRuns;
    ASSERT_EQ(mse.varying.size(), 1u);
    EXPECT_EQ(mse.varying.front().first, 8);  // 6, in steps of a sixteenth of the recording
    const double log_mse =
        std::log(error_metrics(*box(*uniform(pool, 0), pool), truth(), {})["mse"].value);
    sum += log_mse;
    squares += log_mse * log_mse;
  }
  const double variance = (squares - sum * sum / kRuns) / (kRuns - 1);
  // Of 60 recordings the variance has a standard error of 18 %.
  EXPECT_NEAR(between / variance, 1.0, 0.5);
}

TEST(FreshSamples, HalvesOfASelectionAreAppliedToHalves) {
  const SamplePool pool = rare_events(3);
  Selection decided = *look_again_at_the_bright(pool, 0);
  decided.halves = {*look_again_at_the_bright(pool.half(0), 0),
                    *look_again_at_the_bright(pool.half(1), 0)};
  const SamplePool other = rare_events(4);
  const Selection fresh = with_samples_of(other, decided);
  ASSERT_EQ(fresh.halves.size(), 2u);
  EXPECT_EQ(fresh.halves[1].statistics.n, decided.halves[1].statistics.n);
  EXPECT_EQ(fresh.halves[1].statistics.mean,
            prefix_statistics(other.half(1), decided.halves[1].statistics.n).mean);
}

TEST(FreshSamples, ThereAreNoneWhereAHalfIsTooShort) {
  const SamplePool pool = rare_events(5);
  const auto never = [](const SamplePool&, std::size_t) -> Result<Selection> {
    ADD_FAILURE() << "asked";
    return fail(ErrorCode::kData, "asked");
  };
  const auto halves = select_halves(pool, kSide * kSide * 33, false, never);
  ASSERT_TRUE(halves.has_value());
  EXPECT_FALSE(halves->has_value());
}

}  // namespace
}  // namespace spool
