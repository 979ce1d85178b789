#include "lib/inference/budget_curve.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/random_images.h"

namespace spool {
namespace {

Series noisy(double error, double noise, std::uint64_t seed, int replicates = 8) {
  Series series;
  for (int r = 0; r < replicates; ++r)
    series.values.push_back(error * std::exp(noise * test::normal(seed, static_cast<unsigned>(r))));
  return series;
}

BudgetCurve power_law(double at_one, double slope, double noise, std::uint64_t seed) {
  BudgetCurve curve{{2, 4, 8, 16, 32}, {}};
  for (const double spp : curve.spp)
    curve.series.push_back(noisy(at_one * std::pow(spp, slope), noise, mix(seed, spp)));
  return curve;
}

TEST(LogSlope, FindsThePowerLawAndLeavesOutWhatHasNoLogarithm) {
  const double budget[] = {2, 4, 8}, error[] = {3.0 / 2, 3.0 / 4, 3.0 / 8};
  EXPECT_NEAR(log_slope(budget, error), -1.0, 1e-12);
  const double negative[] = {1.0, -0.1, 0.25};
  EXPECT_NEAR(log_slope(budget, negative), -1.0, 1e-12);
  EXPECT_TRUE(std::isnan(log_slope({budget, 1}, {error, 1})));
}

TEST(BudgetCurve, AnExactPowerLawHasItsSlopeAndItsSamples) {
  const BudgetCurve curve = power_law(3.0, -0.8, 0.0, 1);
  const Interval slope = error_slope(curve);
  EXPECT_NEAR(slope.mean, -0.8, 1e-12);
  EXPECT_NEAR(slope.high, -0.8, 1e-9);
  const SamplesNeeded needed = samples_needed(curve, noisy(3.0 * std::pow(11.0, -0.8), 0.0, 2));
  EXPECT_NEAR(needed.spp, 11.0, 1e-9);
  EXPECT_NEAR(needed.low, 11.0, 1e-6);
  EXPECT_NEAR(needed.high, 11.0, 1e-6);
  EXPECT_FALSE(needed.at_most || needed.more_than);
}

TEST(BudgetCurve, OutsideTheMeasuredBudgetsTheEndIsGivenWithAMark) {
  const BudgetCurve curve = power_law(3.0, -1.0, 0.01, 3);
  const SamplesNeeded easy = samples_needed(curve, noisy(50.0, 0.01, 4));
  EXPECT_TRUE(easy.at_most);
  EXPECT_EQ(easy.spp, 2.0);
  EXPECT_EQ(easy.high, 2.0);
  const SamplesNeeded hard = samples_needed(curve, noisy(0.001, 0.01, 5));
  EXPECT_TRUE(hard.more_than);
  EXPECT_EQ(hard.spp, 32.0);
  EXPECT_EQ(hard.low, 32.0);
}

// "At most 2" beside an interval up to 4 would say both.
TEST(BudgetCurve, AMarkAgreesWithTheInterval) {
  const BudgetCurve curve = power_law(3.0, -1.0, 0.3, 3);
  const SamplesNeeded easy = samples_needed(curve, noisy(1.6, 0.3, 4));
  EXPECT_EQ(easy.spp, 2.0);
  EXPECT_GT(easy.high, 2.0);
  EXPECT_FALSE(easy.at_most);
  const SamplesNeeded hard = samples_needed(curve, noisy(0.09, 0.3, 5));
  EXPECT_EQ(hard.spp, 32.0);
  EXPECT_LT(hard.low, 32.0);
  EXPECT_FALSE(hard.more_than);
}

// "32 to 32" beside 25 would be an interval that nothing says.
TEST(BudgetCurve, NoIntervalEndsBesideABudgetWhoseOwnIsWithheld) {
  const BudgetCurve whole = power_law(3.0, -1.0, 0.01, 3);
  for (const auto& [error, after] : {std::pair{0.4, 2u}, {0.12, 4u}}) {
    const Series target = noisy(error, 0.01, 4);
    const SamplesNeeded known = samples_needed(whole, target);
    ASSERT_TRUE(known.low < known.spp && known.spp < known.high);
    ASSERT_TRUE(whole.spp[after - 1] < known.low && known.high < whole.spp[after]);
    for (std::size_t b = 0; b < whole.spp.size(); ++b) {
      BudgetCurve curve = whole;
      curve.series[b].withheld = Withheld::kFewPixels;
      const SamplesNeeded needed = samples_needed(curve, target);
      EXPECT_EQ(needed.spp, known.spp);
      const bool beside = b <= 1 || b + 1 == after || b == after;  // or the first is not known
      EXPECT_EQ(std::isnan(needed.low), beside) << error << ", withheld: " << b;
      EXPECT_EQ(std::isnan(needed.high), beside) << error << ", withheld: " << b;
      if (!beside) EXPECT_TRUE(needed.low == known.low && needed.high == known.high);
    }
  }
}

// What is left of a debiased error without its values below zero is too large.
TEST(BudgetCurve, NothingIsKnownWhereAValueIsNotPositive) {
  BudgetCurve curve = power_law(3.0, -1.0, 0.1, 7);
  const Series target = noisy(0.5, 0.1, 8);
  ASSERT_TRUE(std::isfinite(samples_needed(curve, target).spp));
  curve.series.back().values[2] = -0.01;
  EXPECT_TRUE(std::isnan(error_slope(curve).mean));
  EXPECT_TRUE(std::isnan(samples_needed(curve, target).spp));
  EXPECT_TRUE(std::isnan(samples_needed(power_law(3.0, -1.0, 0.1, 7), curve.series.back()).spp));
}

// 95 % +- 4 standard deviations of 3.1 of 200.
TEST(BudgetCurve, IntervalsHoldTheTruthMostly) {
  int slope_holds = 0, samples_hold = 0;
  for (std::uint64_t trial = 0; trial < 200; ++trial) {
    const BudgetCurve curve = power_law(3.0, -0.9, 0.05, 100 + trial);
    const Interval slope = error_slope(curve);
    slope_holds += slope.low <= -0.9 && -0.9 <= slope.high;
    const SamplesNeeded needed =
        samples_needed(curve, noisy(3.0 * std::pow(8.0, -0.9), 0.05, 900 + trial));
    samples_hold += needed.low <= 8.0 && 8.0 <= needed.high;
  }
  EXPECT_NEAR(slope_holds, 190, 4 * 3.1);
  EXPECT_NEAR(samples_hold, 190, 4 * 3.1);
}

TEST(BudgetCurve, AReplicateWithoutValueIsLeftOut) {
  BudgetCurve curve = power_law(3.0, -1.0, 0.1, 7);
  for (Series& series : curve.series)
    series.values[2] = std::nan("");
  EXPECT_EQ(error_slope(curve).n, 7);
  const Series none{std::vector<double>(8, std::nan(""))};
  EXPECT_TRUE(std::isnan(samples_needed(curve, none).spp));
}

}  // namespace
}  // namespace spool
