#include "lib/inference/comparison.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/random_images.h"

namespace spool {
namespace {

MetricOptions fast_options() {
  MetricOptions options;
  options.perceptual = Perceptual::kNone;
  return options;
}

// MSE of images with white noise of the given sigma, one per replicate. `shared` noise is the same
// for all methods of a replicate.
MethodSeries noisy_method(const std::string& name, double sigma, std::uint64_t seed,
                          int replicates = 5, double shared = 0.0, int side = 96) {
  const RgbImage flat = make_rgb(side, side, 1.0);
  std::vector<MetricTable> tables;
  for (int r = 0; r < replicates; ++r) {
    const auto word = static_cast<std::uint64_t>(r);
    const RgbImage image =
        test::add_noise(test::add_noise(flat, mix(77, word), shared), mix(seed, word), sigma);
    tables.push_back(error_metrics(image, {flat, {}, {}}, fast_options()));
  }
  std::vector<const MetricTable*> pointers;
  for (const MetricTable& table : tables)
    pointers.push_back(&table);
  return method_series(name, "mse", pointers);
}

TEST(ComparePaired, ErrorsThatDifferAreFoundToDiffer) {
  const PairedComparison found =
      compare_paired(noisy_method("a", 0.30, 1), noisy_method("b", 0.25, 2));
  EXPECT_NEAR(found.difference, 0.09 - 0.0625, 4 * found.standard_error);
  EXPECT_LT(found.p, 1e-6);
  EXPECT_GT(found.low, 0.0);
}

TEST(ComparePaired, WhatBothShareCancels) {
  const PairedComparison apart =
      compare_paired(noisy_method("a", 0.1, 1, 5, 1.0), noisy_method("b", 0.1, 2, 5, 1.0));
  const MethodSeries alone = noisy_method("a", 0.1, 1, 5, 1.0);
  const double standard_error_of_one = standard_error_of(alone.resampled[0]) / std::sqrt(5.0);
  EXPECT_LT(apart.standard_error, 0.4 * standard_error_of_one);
}

TEST(ComparePaired, AMethodDoesNotDifferFromItself) {
  const MethodSeries a = noisy_method("a", 0.3, 1);
  const PairedComparison found = compare_paired(a, a);
  EXPECT_EQ(found.difference, 0.0);
  EXPECT_EQ(found.p, 1.0);
}

TEST(ComparePaired, ReplicatesWithoutValueAreLeftOut) {
  MethodSeries a = noisy_method("a", 0.3, 1), b = noisy_method("b", 0.3, 2);
  a.values[2] = std::nan("");
  double sum = 0.0;
  for (const std::size_t r : {0u, 1u, 3u, 4u})
    sum += a.values[r] - b.values[r];
  EXPECT_DOUBLE_EQ(compare_paired(a, b).difference, sum / 4);
  for (double& value : a.values)
    value = std::nan("");
  EXPECT_TRUE(std::isnan(compare_paired(a, b).difference));
  EXPECT_EQ(compare_paired(a, b).p, 1.0);
}

// Two methods of equal error: 5 % of the comparisons find a difference. 200 trials: within 4
// standard deviations of 3.1 above, and more than one (with the noise counted twice: none).
TEST(ComparePaired, RarelyFindsADifferenceWhereThereIsNone) {
  int found = 0;
  for (std::uint64_t trial = 0; trial < 200; ++trial) {
    found += compare_paired(noisy_method("a", 0.3, mix(trial, 1), 4, 0.0, 64),
                            noisy_method("b", 0.3, mix(trial, 2), 4, 0.0, 64))
                 .p < 0.05;
  }
  EXPECT_LT(found, 10 + 4 * 3.1);
  EXPECT_GT(found, 1);
}

// The 95 % interval of a single image's MSE holds the truth in 93 .. 97 % of 1000 trials.
TEST(BlockBootstrap, IntervalsCoverTheTruth) {
  const RgbImage flat = make_rgb(128, 112, 1.0);
  int covered = 0;
  for (std::uint64_t trial = 0; trial < 1000; ++trial) {
    const MetricValue mse = error_metrics(test::add_noise(flat, mix(5, trial), 0.3), {flat, {}, {}},
                                          fast_options())["mse"];
    covered += std::abs(mse.value - 0.09) <= 1.96 * mse.standard_error;
  }
  EXPECT_GE(covered, 930);
  EXPECT_LE(covered, 970);
}

TEST(Holm, ByHand) {
  const double p[] = {0.01, 0.04, 0.03, 0.005};
  // Sorted .005 .01 .03 .04 times 4 3 2 1 = .02 .03 .06 .04 -> never falling.
  const std::vector<double> adjusted = holm_adjusted(p);
  EXPECT_DOUBLE_EQ(adjusted[3], 0.02);
  EXPECT_DOUBLE_EQ(adjusted[0], 0.03);
  EXPECT_DOUBLE_EQ(adjusted[2], 0.06);
  EXPECT_DOUBLE_EQ(adjusted[1], 0.06);
  EXPECT_EQ(holm_adjusted(std::vector<double>{0.9, 0.8})[0], 1.0);
}

TEST(RankMethods, TiesShareARank) {
  const std::vector<MethodSeries> methods = {
      noisy_method("worst", 0.5, 1), noisy_method("b", 0.25, 2), noisy_method("a", 0.25, 3)};
  const auto ranked = rank_methods(methods, Better::kLower);
  EXPECT_EQ(ranked[0].rank, 1);
  EXPECT_EQ(ranked[1].rank, 1);
  EXPECT_EQ(ranked[2].rank, 3);
  EXPECT_EQ(ranked[2].method, 0u);
  EXPECT_LT(ranked[2].p_against_best, 1e-6);
  EXPECT_EQ(ranked[0].p_against_best, 1.0);
  const auto upside_down = rank_methods(methods, Better::kHigher);
  EXPECT_EQ(upside_down[0].method, 0u);
  EXPECT_EQ(upside_down[1].rank, 2);
  EXPECT_EQ(upside_down[2].rank, 2);
}

TEST(RankMethods, RatiosAreRankedByTheirDistanceFromOne) {
  const auto fixed = [](const char* name, double value) {
    return MethodSeries{name, {value, value}, {{value, value + 1e-4}, {value, value - 1e-4}}};
  };
  const std::vector<MethodSeries> methods = {fixed("much", 1.3), fixed("near", 0.9)};
  const auto ranked = rank_methods(methods, Better::kOne);
  EXPECT_EQ(ranked[0].method, 1u);
  EXPECT_EQ(ranked[1].rank, 2);
}

TEST(ErrorOverBudget, FindsThePowerLaw) {
  const double budget[] = {2, 4, 8, 16};
  const double error[] = {3.0 / 2, 3.0 / 4, 3.0 / 8, 3.0 / 16};
  const BudgetFit fit = fit_error_over_budget(budget, error);
  EXPECT_EQ(fit.points, 4);
  EXPECT_NEAR(fit.slope, -1.0, 1e-12);
  EXPECT_NEAR(std::exp(fit.intercept), 3.0, 1e-12);
  EXPECT_NEAR(fit.slope_standard_error, 0.0, 1e-7);
}

TEST(ErrorOverBudget, LeavesOutWhatHasNoLogarithm) {
  const double budget[] = {2, 4, 8};
  const double error[] = {1.0, -0.1, 0.25};
  const BudgetFit fit = fit_error_over_budget(budget, error);
  EXPECT_EQ(fit.points, 2);
  EXPECT_NEAR(fit.slope, -1.0, 1e-12);
  EXPECT_TRUE(std::isnan(fit.slope_standard_error));
  EXPECT_TRUE(std::isnan(fit_error_over_budget({budget, 1}, {error, 1}).slope));
}

}  // namespace
}  // namespace spool
