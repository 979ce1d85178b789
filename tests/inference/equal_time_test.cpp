// Errors in another method's time, and how much more would tell two methods apart.
#include "lib/inference/equal_time.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lib/inference/comparison.h"
#include "lib/inference/log_combination.h"
#include "tests/support/random_images.h"

namespace spool {
namespace {

Series noisy(double error, double noise, std::uint64_t seed) {
  Series series;
  for (unsigned r = 0; r < 8; ++r)
    series.values.push_back(error * std::exp(noise * test::normal(seed, r)));
  return series;
}

TEST(EqualTime, APowerLawIsReadExactlyBetweenItsBudgets) {
  // Error 3 / t at 1, 4 and 16 seconds; the other has 0.5 at 5 seconds.
  const Series a = noisy(3.0, 0, 1), b = noisy(0.75, 0, 2), c = noisy(0.1875, 0, 3);
  const Series target = noisy(0.5, 0, 4);
  const TimedError curve[] = {{16.0, &c}, {1.0, &a}, {4.0, &b}};
  const EqualTime found = equal_time(curve, {5.0, &target});
  ASSERT_TRUE(found.known());
  EXPECT_NEAR(found.ratio.mean, 3.0 / 5.0 / 0.5, 1e-12);
  EXPECT_NEAR(equal_time(curve, {16.0, &target}).ratio.mean, 0.1875 / 0.5, 1e-12);
  EXPECT_NEAR(equal_time(curve, {1.0, &target}).ratio.mean, 3.0 / 0.5, 1e-12);
}

TEST(EqualTime, NothingIsReadBeyondTheBudgets) {
  const Series a = noisy(3.0, 0, 1), b = noisy(0.75, 0, 2);
  const TimedError curve[] = {{1.0, &a}, {4.0, &b}};
  EXPECT_TRUE(equal_time(curve, {0.9, &a}).too_slow);
  EXPECT_TRUE(equal_time(curve, {4.1, &a}).too_fast);
  EXPECT_FALSE(equal_time(curve, {4.1, &a}).known());
  EXPECT_FALSE(equal_time({}, {1.0, &a}).known());
  const TimedError unknown[] = {{std::nan(""), &a}};
  EXPECT_FALSE(equal_time(unknown, {1.0, &a}).known());
  EXPECT_FALSE(equal_time(curve, {std::nan(""), &a}).known());
}

TEST(EqualTime, IsNotKnownWhereAValueIsNotPositive) {
  Series a = noisy(3.0, 0.1, 1);
  const Series b = noisy(0.75, 0.1, 2);
  a.values[5] = 0.0;
  const TimedError curve[] = {{1.0, &a}, {4.0, &b}};
  EXPECT_FALSE(equal_time(curve, {2.0, &b}).known());
}

TEST(EqualTime, WhatIsWithheldStaysSo) {
  Series a = noisy(3.0, 0.1, 1);
  const Series b = noisy(0.75, 0.1, 2);
  const TimedError curve[] = {{1.0, &a}, {4.0, &b}};
  EXPECT_TRUE(std::isfinite(equal_time(curve, {2.0, &b}).ratio.low));
  a.withheld = Withheld::kFewPixels;
  EXPECT_TRUE(std::isnan(equal_time(curve, {2.0, &b}).ratio.low));
  EXPECT_TRUE(equal_time(curve, {2.0, &b}).known());
}

TEST(LogCombination, HalvesGoAlongWithTheirWeights) {
  Series a = noisy(1.0, 0.1, 1), b = noisy(2.0, 0.1, 2);
  a.halves = {HalfDifference{1, {0.4}, {}}};
  b.halves = {HalfDifference{1, {0.1}, {}}};
  const Series half =
      log_combination(std::vector<WeightedSeries>{{0.5, &a}, {0.25, &a}, {-1.0, &b}});
  EXPECT_NEAR(half.halves.at(0).cells.at(0), 0.75 * 0.4 - 0.1, 1e-15);
  EXPECT_NEAR(half.values[3], 0.75 * std::log(a.values[3]) - std::log(b.values[3]), 1e-12);
}

Comparison measured(double difference, double standard_error, int n, double correlation) {
  Comparison c;
  c.n = n;
  c.difference = difference;
  c.standard_error = standard_error;
  c.freedom = n - 1.0;
  c.correlation = correlation;
  c.p = 0.5;
  return c;
}

// Seen from the other side: with so many replicates, the share of experiments that tell is 80 %.
TEST(MoreNeeded, AsManyReplicatesTellInFourOfFive) {
  const double difference = 0.2, deviation = 0.5;
  const MoreNeeded more = more_needed(measured(difference, deviation / std::sqrt(8.0), 8, 0.0), 1);
  const double of_normal = std::ceil(std::pow(2.8015852 * deviation / difference, 2));
  EXPECT_GE(more.replicates, of_normal);
  EXPECT_LE(more.replicates, of_normal + 3);
  int told = 0;
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    Series a, b;
    for (unsigned r = 0; r < static_cast<unsigned>(more.replicates); ++r) {
      a.values.push_back(1.0);
      b.values.push_back(std::exp(difference + deviation * test::normal(seed, r)));
    }
    a.values[0] = 1.0 + 1e-12;  // not the same in all replicates
    told += compare_paired(a, b, Better::kLower).p < 0.05;
  }
  EXPECT_NEAR(told, 400, 3 * 9);
}

TEST(MoreNeeded, ReplicatesThatShareTheirErrorNeverTell) {
  const MoreNeeded more = more_needed(measured(0.1, 0.2, 8, 0.9), 2);
  EXPECT_TRUE(std::isinf(more.replicates));
  EXPECT_NEAR(more.recordings, 2 * std::pow(2.8015852 * 0.2 / 0.1, 2), 5);
}

// Seen from the other side: recordings that differ by as much as was measured on halves, with their
// freedom of 20. The third leaves two degrees of freedom, which would tell in one of three.
TEST(MoreNeeded, RecordingsHaveTheFreedomOfTheRuleThatWillJudgeThem) {
  Comparison c = measured(1.0, 0.45 / std::sqrt(2.0), 16, 0.0);
  c.freedom = 20.0;
  const double level = 0.01, recordings = more_needed(c, 2, level).recordings;
  EXPECT_GT(recordings, 3.0);
  const auto told = [&](double number) {
    int count = 0;
    for (std::uint64_t seed = 0; seed < 500; ++seed) {
      Series a, b;
      a.recordings = b.recordings = static_cast<int>(number);
      for (unsigned r = 0; r < static_cast<unsigned>(number); ++r) {
        a.values.push_back(std::exp(1e-9 * r));
        b.values.push_back(std::exp(1.0 + 0.45 * test::normal(seed, r)));
      }
      count += compare_paired(a, b, Better::kLower).p < level;
    }
    return count;
  };
  EXPECT_LT(told(3), 250);
  EXPECT_GE(told(recordings), 400 - 3 * 9);
  EXPECT_EQ(more_needed(c, 1, level).recordings, 2.0);  // which halves judge
  // Replicates of three recordings add no freedom.
  c.freedom = 2.0;
  EXPECT_GT(more_needed(c, 3, level).replicates, 1.5 * more_needed(c, 2, level).replicates);
}

// Few replicates and many pairs: the normal quantile would promise 9, which tell in one of three.
TEST(MoreNeeded, FewReplicatesKnowTheirSpreadBadly) {
  const double replicates = more_needed(measured(4.0, 1.0, 8, 0.0), 1, 0.05 / 66).replicates;
  EXPECT_GE(replicates, 13);
  EXPECT_LE(replicates, 16);
}

}  // namespace
}  // namespace spool
