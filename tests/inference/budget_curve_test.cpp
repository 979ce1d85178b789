#include "lib/inference/budget_curve.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lib/core/random.h"

namespace spool {
namespace {

// `error` with independent noise of relative size `noise` in replicates and resamples.
MethodSeries noisy(double error, double noise, std::uint64_t seed, int replicates = 5) {
  const auto gauss = [&](std::uint64_t a, std::uint64_t b) {
    double sum = -6.0;
    for (std::uint64_t i = 0; i < 12; ++i)
      sum += unit_double(mix(seed, a, b, i));
    return sum;
  };
  MethodSeries series{"m", {}, {}};
  for (std::uint64_t r = 0; r < static_cast<std::uint64_t>(replicates); ++r) {
    series.values.push_back(error * (1.0 + noise * gauss(r, 0)));
    std::vector<double>& resampled = series.resampled.emplace_back();
    for (std::uint64_t s = 1; s <= 200; ++s)
      resampled.push_back(series.values.back() * (1.0 + noise * gauss(r, s)));
  }
  return series;
}

BudgetCurve power_law(double at_one, double slope, double noise, std::uint64_t seed) {
  BudgetCurve curve{{2, 4, 8, 16, 32}, {}};
  for (const double spp : curve.spp)
    curve.series.push_back(noisy(at_one * std::pow(spp, slope), noise, mix(seed, spp)));
  return curve;
}

TEST(BudgetCurve, AnExactPowerLawHasItsSlopeAndItsSamples) {
  const BudgetCurve curve = power_law(3.0, -0.8, 0.0, 1);
  const ErrorSlope slope = error_slope(curve);
  EXPECT_NEAR(slope.fit.slope, -0.8, 1e-12);
  EXPECT_NEAR(slope.low, -0.8, 1e-12);
  EXPECT_NEAR(slope.high, -0.8, 1e-12);
  const SamplesNeeded needed = samples_needed(curve, noisy(3.0 * std::pow(11.0, -0.8), 0.0, 2));
  EXPECT_NEAR(needed.spp, 11.0, 1e-9);
  EXPECT_NEAR(needed.low, 11.0, 1e-9);
  EXPECT_NEAR(needed.high, 11.0, 1e-9);
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

TEST(BudgetCurve, IntervalsWidenWithTheNoiseAndHoldTheTruthMostly) {
  int slope_holds = 0, samples_hold = 0;
  double narrow = 0.0, wide = 0.0;
  for (std::uint64_t trial = 0; trial < 200; ++trial) {
    const BudgetCurve curve = power_law(3.0, -0.9, 0.05, 100 + trial);
    const ErrorSlope slope = error_slope(curve);
    slope_holds += slope.low <= -0.9 && -0.9 <= slope.high;
    const SamplesNeeded needed =
        samples_needed(curve, noisy(3.0 * std::pow(10.0, -0.9), 0.05, 900 + trial));
    samples_hold += needed.low <= 10.0 && 10.0 <= needed.high;
    narrow += slope.high - slope.low;
    const ErrorSlope rough = error_slope(power_law(3.0, -0.9, 0.15, 100 + trial));
    wide += rough.high - rough.low;
  }
  EXPECT_GT(wide, 2.0 * narrow);
  // 95 % +- 4 standard deviations of 3.1; the noise of a replicate, which is in its resamples and
  // in its value, counts once.
  EXPECT_GE(slope_holds, 178);
  EXPECT_GE(samples_hold, 178);
  EXPECT_LT(slope_holds, 200);
  EXPECT_LT(samples_hold, 200);
}

TEST(BudgetCurve, AReplicateWithoutValueIsLeftOut) {
  MethodSeries series = noisy(1.0, 0.1, 7);
  MethodSeries shorter = series;
  series.values[2] = std::nan("");
  shorter.values.erase(shorter.values.begin() + 2);
  shorter.resampled.erase(shorter.resampled.begin() + 2);
  EXPECT_EQ(resampled_mean(series).means, resampled_mean(shorter).means);
  EXPECT_TRUE(resampled_mean(MethodSeries{"none", {std::nan("")}, {{}}}).means.empty());
  EXPECT_TRUE(
      std::isnan(samples_needed({{4}, {MethodSeries{"none", {std::nan("")}, {{}}}}}, series).spp));
}

TEST(RankAgainstBest, TellsTheBestGroupFromTheRest) {
  const std::vector<MethodSeries> methods = {noisy(1.5, 0.01, 1), noisy(1.0, 0.02, 22),
                                             noisy(1.001, 0.02, 23), noisy(2.0, 0.01, 4)};
  const auto ranked = rank_against_best(methods, Better::kLower);
  ASSERT_EQ(ranked.size(), 4u);
  EXPECT_EQ(ranked[2].method, 0u);
  EXPECT_EQ(ranked[3].method, 3u);
  EXPECT_EQ(ranked[0].rank, 1);
  EXPECT_EQ(ranked[1].rank, 1);
  EXPECT_EQ(ranked[2].rank, 2);
  EXPECT_EQ(ranked[3].rank, 2);
  EXPECT_EQ(rank_against_best(methods, Better::kHigher)[0].method, 3u);
}

}  // namespace
}  // namespace spool
