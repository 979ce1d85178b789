// Samples that decide are not averaged: what that cures and what it costs.
#include "lib/experiment/decision_split.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lib/filters/filters.h"
#include "lib/sampling/samplers.h"
#include "lib/sampling/spending.h"
#include "tests/support/memory_pool.h"

namespace spool {
namespace {

constexpr int kSide = 64, kSamples = 96, kBudget = kSide * kSide * 8;

// Rare bright events: 20 with probability 0.05, mean 1, everywhere alike.
SamplePool rare_events(std::uint64_t seed) {
  return test::pool_of(test::memory_recording(kSide, kSide, kSamples, [=](int x, int y, int s) {
    const float value = unit_double(mix(seed, x, y, s)) < 0.05 ? 20.0f : 0.0f;
    return Rgb{value, value, value};
  }));
}

double mean_of(const RgbImage& image) {
  double sum = 0.0;
  for (const double v : image[1].pixels())
    sum += v;
  return sum / static_cast<double>(image[1].size());
}

const ReadyFilter& box() {
  static const ReadyFilter filter = average_halves(*make_method(filters(), {"box", "", {}}));
  return filter;
}

TEST(DecisionSplit, IsUnbiasedWhereTheAdaptiveMeanLosesEnergy) {
  const auto ordinary = *make_method(samplers(), {"multiscale", "", {{"epochs", "24"}}});
  const auto split = split_decisions(ordinary);
  constexpr int kRuns = 6;
  double ordinary_mean = 0.0, split_mean = 0.0, square = 0.0;
  for (int r = 0; r < kRuns; ++r) {
    const SamplePool pool = rare_events(static_cast<std::uint64_t>(r));
    ordinary_mean += mean_of(
        box()(ordinary(pool, kBudget, SamplingContext{})->selection, pool, FilterContext{})->image);
    const auto sampled = split(pool, kBudget, SamplingContext{});
    ASSERT_TRUE(sampled.has_value()) << sampled.error().message;
    const RgbImage image = box()(sampled->selection, pool, FilterContext{})->image;
    split_mean += mean_of(image);
    for (const double v : image[1].pixels())
      square += (v - 1.0) * (v - 1.0);
  }
  const double pixels = kRuns * kSide * kSide;
  EXPECT_LT(ordinary_mean / kRuns, 0.85);  // what was dark by chance is not looked at again
  // Pixels are not quite independent, as neighbours share decisions, but their values given the
  // counts are: four standard errors.
  const double standard_error = std::sqrt(square / pixels / pixels);
  EXPECT_NEAR(split_mean / kRuns, 1.0, 4.0 * standard_error);
  EXPECT_LT(standard_error, 0.02);
}

TEST(DecisionSplit, EachHalfIsCountedByTheOther) {
  const SamplePool pool = rare_events(3);
  const auto sampler = *make_method(samplers(), {"multiscale", "", {{"epochs", "8"}}});
  SamplingContext context;
  context.seed = 5;
  const auto sampled = split_decisions(sampler)(pool, kBudget + 1, context);
  ASSERT_EQ(sampled->selection.halves.size(), 2u);
  long long averaged = 0;
  for (int h = 0; h < 2; ++h) {
    SamplingContext of_half;
    of_half.seed = mix(context.seed, static_cast<std::size_t>(h));
    const auto decided = sampler(pool.half(h), kBudget / 2 + 1 - h, of_half);
    const Selection& other = sampled->selection.halves[static_cast<std::size_t>(1 - h)];
    EXPECT_EQ(other.statistics.n, decided->selection.statistics.n);
    EXPECT_EQ(other.attenuation, decided->selection.attenuation);
    EXPECT_EQ(other.statistics.mean, prefix_statistics(pool.half(1 - h), other.statistics.n).mean);
    averaged += count_samples(other.statistics.n);
  }
  EXPECT_EQ(averaged, kBudget + 1);
  // Everything that was looked at lies in the prefixes, and nothing of them is idle.
  const CountImage& n = sampled->selection.statistics.n;
  const CountImage& even = sampled->selection.halves[0].statistics.n;
  const CountImage& odd = sampled->selection.halves[1].statistics.n;
  for (std::size_t i = 0; i < n.size(); ++i)
    ASSERT_EQ(n[i], 2 * std::max(even[i], odd[i]));
  EXPECT_EQ(sampled->log.spent, count_samples(n));
  EXPECT_GT(sampled->log.spent, kBudget + 1);
}

TEST(DecisionSplit, NoSampleOfAHalfChangesItsOwnCount) {
  const auto pool_with = [](float scale_of_odd) {
    return test::pool_of(test::memory_recording(32, 32, 32, [=](int x, int y, int s) {
      const auto v = static_cast<float>(unit_double(mix(1, x, y, s)));
      const float value = s % 2 == 1 ? scale_of_odd * v * v : v;
      return Rgb{value, value, value};
    }));
  };
  const auto split =
      split_decisions(*make_method(samplers(), {"multiscale", "", {{"epochs", "8"}}}));
  const auto a = split(pool_with(1.0f), 32 * 32 * 8, SamplingContext{});
  const auto b = split(pool_with(9.0f), 32 * 32 * 8, SamplingContext{});
  EXPECT_EQ(a->selection.halves[1].statistics.n, b->selection.halves[1].statistics.n);
  EXPECT_NE(a->selection.halves[1].statistics.mean, b->selection.halves[1].statistics.mean);
}

TEST(DecisionSplit, OfUniformCountsTheImageIsTheOrdinaryOne) {
  const SamplePool pool = rare_events(1);
  const auto uniform = *make_method(samplers(), {"uniform", "", {}});
  const auto split = split_decisions(uniform)(pool, kBudget, SamplingContext{});
  EXPECT_EQ(split->log.spent, kBudget);
  const auto image = box()(split->selection, pool, FilterContext{})->image;
  const auto ordinary =
      box()(uniform(pool, kBudget, SamplingContext{})->selection, pool, FilterContext{})->image;
  for (std::size_t i = 0; i < image[0].size(); ++i)
    ASSERT_NEAR(image[0][i], ordinary[0][i], 1e-12);
}

TEST(DecisionSplit, PoolsOfOddLengthAreAveragedAsFarAsTheyGo) {
  const SamplePool pool = test::pool_of(test::memory_recording(9, 7, 5, [](int x, int y, int s) {
    const auto value = static_cast<float>(unit_double(mix(4, x, y, s)));
    return Rgb{value, value, value};
  }));
  const auto sampled = split_decisions(*make_method(samplers(), {"uniform", "", {}}))(
      pool, 9 * 7 * 5, SamplingContext{});
  ASSERT_TRUE(sampled.has_value());
  for (int h = 0; h < 2; ++h) {
    const CountImage& n = sampled->selection.halves[static_cast<std::size_t>(h)].statistics.n;
    for (const std::int32_t count : n.pixels())
      EXPECT_LE(count, 3 - h);
  }
  EXPECT_LE(count_samples(sampled->selection.statistics.n), 9 * 7 * 5);
  EXPECT_TRUE(box()(sampled->selection, pool, FilterContext{}).has_value());
}

}  // namespace
}  // namespace spool
