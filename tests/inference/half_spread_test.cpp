// The spread between recordings, from differences of halves.
#include "lib/inference/half_spread.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lib/core/random.h"
#include "lib/inference/comparison.h"
#include "lib/inference/intervals.h"

namespace spool {
namespace {

constexpr int kColumns = 8;

double normal(std::uint64_t a, std::uint64_t b) {
  const double u = unit_double(mix(a, b, 1)), v = unit_double(mix(a, b, 2));
  return std::sqrt(-2.0 * std::log(1.0 - u)) * std::cos(2.0 * M_PI * v);
}

// Cells that vary normally, with the given standard deviation of (a - b) / mean.
HalfDifference cells(std::uint64_t seed, double deviation, int alone = -1) {
  HalfDifference split{kColumns, std::vector<double>(kColumns * kColumns), {}};
  for (std::size_t c = 0; c < split.cells.size(); ++c) {
    if (alone < 0 || static_cast<int>(c) == alone) split.cells[c] = deviation * normal(seed, c);
  }
  return split;
}

TEST(HalfSpread, VarianceIsHalfThatOfTheDifferenceForCellsThatVaryIndependently) {
  double mean = 0.0;
  constexpr int kRuns = 200;
  for (std::uint64_t r = 0; r < kRuns; ++r)
    mean += half_variance(std::vector{cells(r, 0.1), cells(1000 + r, 0.1)}).variance / kRuns;
  // 64 cells of 0.01 each, halved. Standard error of the mean: about 1.3 %.
  EXPECT_NEAR(mean, 0.32, 0.32 * 0.06);
}

TEST(HalfSpread, NeighboursThatVaryTogetherCountTogether) {
  HalfDifference split{kColumns, std::vector<double>(kColumns * kColumns), {}};
  for (const std::size_t c : {27u, 28u, 35u, 36u})
    split.cells[c] = 0.25;
  // Alone: 4 / 16. Together 1; the windows that hold all, two or one of them: 1 + 4/4 + 4/16, / 4.
  EXPECT_NEAR(half_variance(std::vector{split}).variance, 0.5 * (1.0 + 1.0 + 0.25) / 4.0, 1e-15);
}

TEST(HalfSpread, OneCellThatCarriesAllLeavesOneDegreeOfFreedom) {
  EXPECT_EQ(half_variance(std::vector{cells(1, 1.0, 20), cells(2, 1.0, 20)}).freedom, 1.0);
  const double many = half_variance(std::vector{cells(3, 1.0), cells(4, 1.0)}).freedom;
  EXPECT_GT(many, 15.0);
  EXPECT_LT(many, 40.0);
  EXPECT_EQ(half_variance({}).freedom, 0.0);
}

TEST(HalfSpread, DifferencesNeedTheSameCells) {
  const std::vector a = {cells(1, 1.0)}, b = {cells(2, 1.0)};
  const auto difference = difference_of(a, 1.0, b, 2.0);
  ASSERT_EQ(difference.size(), 1u);
  EXPECT_EQ(difference[0].cells[5], a[0].cells[5] - 2.0 * b[0].cells[5]);
  EXPECT_TRUE(difference_of(a, 1.0, std::vector{HalfDifference{2, {1.0, 2.0}, {}}}, 1.0).empty());
  EXPECT_TRUE(difference_of(a, 1.0, {}, 1.0).empty());
  EXPECT_EQ(half_variance(std::vector{a[0], HalfDifference{2, {1.0, 2.0}, {}}}).freedom, 0.0);
}

// One method has no halves of the first replicate: what both share in the others cancels still.
TEST(HalfSpread, HalvesAreThoseOfTheSameReplicates) {
  std::vector a = {cells(1, 0.2), cells(2, 0.2), cells(3, 0.2)};
  for (int r = 0; r < 3; ++r)
    a[static_cast<std::size_t>(r)].replicate = r;
  const std::vector b(a.begin() + 1, a.end());
  for (const auto& found : {difference_of(a, 1.0, b, 1.0), difference_of(b, 1.0, a, 1.0)}) {
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(half_variance(found).variance, 0.0);
    EXPECT_EQ(found[1].replicate, 2);
  }
  const Series first{{1.0, 1.2, 0.9}, 0.5, {}, a}, second{{2.0, 2.4, 1.8}, 0.5, {}, b};
  EXPECT_LT(compare_paired(first, second, Better::kLower).standard_error, 1e-9);
}

// Replicates that are the same picture but for a trace: their own scatter says nothing.
TEST(HalfSpread, ReplicatesThatShareTheirErrorHaveTheIntervalOfTheHalves) {
  Series series{{1.0, 1.001, 0.999, 1.0}, 1.0, {}, {cells(1, 0.05), cells(2, 0.05)}};
  const HalfSpread between = half_variance(series.halves);
  const Interval found = mean_interval(series, Range::kPositive);
  EXPECT_NEAR(found.standard_error, std::sqrt(between.variance), 1e-4);
  EXPECT_NEAR(found.freedom, between.freedom, 1e-9);
  series.correlation = 0.0;
  EXPECT_LT(mean_interval(series, Range::kPositive).standard_error,
            0.51 * std::sqrt(between.variance));
}

// The first method's replicates share nearly all of their error, the second one's nothing: what the
// second one adds to the difference is not taken for a hundredth of what varies.
TEST(HalfSpread, AMethodThatSharesItsErrorDoesNotMakeTheOtherOnesAlike) {
  Series shared{{}, 0.999, {}, {cells(3, 0.3, 10), cells(4, 0.3, 10)}};
  Series apart{{}, 0.01, {}, {cells(5, 0.04), cells(6, 0.04)}};
  for (std::uint64_t r = 0; r < 8; ++r) {
    shared.values.push_back(1.0 + 1e-4 * normal(7, r));
    apart.values.push_back(2.0 * std::exp(0.2 * normal(8, r)));
  }
  const Comparison found = compare_paired(shared, apart, Better::kLower);
  const double of_halves =
      half_variance(shared.halves).variance + half_variance(apart.halves).variance;
  EXPECT_LT(found.standard_error, 2.0 * std::sqrt(of_halves));
  EXPECT_GT(found.standard_error, std::sqrt(half_variance(shared.halves).variance));
}

// What moves the whole image is in no cell: replicates vary more than the halves then.
TEST(HalfSpread, ReplicatesThatVaryMoreThanTheHalvesHaveTheirOwnInterval) {
  const Series series{{1.0, 1.4, 0.7, 1.2}, 0.0, {}, {cells(1, 1e-3), cells(2, 1e-3)}};
  const Interval halves = mean_interval(series), own = mean_interval({series.values});
  EXPECT_NEAR(halves.standard_error, own.standard_error, 1e-12);
  EXPECT_EQ(halves.freedom, 3.0);
  EXPECT_LT(std::sqrt(half_variance(series.halves).variance), 0.1 * own.standard_error);
}

TEST(HalfSpread, WhatTwoMethodsShareCancelsInTheirDifference) {
  const std::vector halves = {cells(1, 0.2), cells(2, 0.2)};
  const Series a{{1.0, 1.2, 0.9, 1.1}, 0.5, {}, halves}, b{{2.0, 2.4, 1.8, 2.21}, 0.5, {}, halves};
  const Comparison same = compare_paired(a, b, Better::kLower);
  EXPECT_LT(same.standard_error, 0.01);
  EXPECT_GT(compare_independent(a, b, Better::kLower).standard_error, 0.2);
}

}  // namespace
}  // namespace spool
