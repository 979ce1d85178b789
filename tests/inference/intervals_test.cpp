#include "lib/inference/intervals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "lib/core/student.h"
#include "tests/support/random_images.h"

namespace spool {
namespace {

TEST(Student, AgreesWithClosedFormsAndTables) {
  // One degree of freedom: tan(pi (p - 1/2)); two: closed form; the rest from printed tables.
  EXPECT_NEAR(student_quantile(0.975, 1), 12.7062047361747, 1e-9);
  EXPECT_NEAR(student_quantile(0.975, 2), 4.30265272974946, 1e-10);
  EXPECT_NEAR(student_quantile(0.975, 4), 2.77644510519779, 1e-10);
  EXPECT_NEAR(student_quantile(0.995, 30), 2.74999565356722, 1e-10);
  EXPECT_NEAR(student_quantile(0.975, 1e7), 1.95996421, 1e-6);
  EXPECT_NEAR(student_two_sided(-12.7062047361747, 1), 0.05, 1e-12);
  EXPECT_EQ(student_two_sided(std::numeric_limits<double>::infinity(), 3), 0.0);
  for (const double p : {0.001, 0.2, 0.5, 0.77, 0.9999})
    EXPECT_NEAR(student_two_sided(student_quantile(p, 2.5), 2.5), 2.0 * std::min(p, 1.0 - p),
                1e-12);
}

TEST(MeanInterval, OfRealValuesByHand) {
  const Interval interval = mean_interval({{1.0, 2.0, 3.0, 4.0, std::nan("")}});
  EXPECT_EQ(interval.n, 4);
  EXPECT_DOUBLE_EQ(interval.mean, 2.5);
  EXPECT_DOUBLE_EQ(interval.standard_error, std::sqrt(5.0 / 3.0 / 4.0));
  EXPECT_NEAR(interval.high - 2.5, 3.18244630528371 * interval.standard_error, 1e-9);
  EXPECT_NEAR(2.5 - interval.low, interval.high - 2.5, 1e-12);
  EXPECT_FALSE(interval.logarithmic);
}

TEST(MeanInterval, OfPositiveValuesIsThatOfTheirLogarithms) {
  const Interval logs = mean_interval({{0.0, 1.0, 5.0}});
  const Interval found = mean_interval({{1.0, std::exp(1.0), std::exp(5.0)}}, Range::kPositive);
  EXPECT_TRUE(found.logarithmic);
  EXPECT_NEAR(std::log(found.mean), 2.0, 1e-12);
  EXPECT_NEAR(std::log(found.low), logs.low, 1e-9);
  EXPECT_NEAR(std::log(found.high), logs.high, 1e-9);
  EXPECT_GT(found.low, 0.0);
}

TEST(MeanInterval, StaysInItsRange) {
  const Interval debiased = mean_interval({{-0.1, 0.4, 0.1}}, Range::kPositive);
  EXPECT_FALSE(debiased.logarithmic);
  EXPECT_EQ(debiased.low, 0.0);
  const Interval below = mean_interval({{-0.1, -0.4, 0.1}}, Range::kPositive);
  EXPECT_NEAR(below.mean - below.low, below.high - below.mean, 1e-12);  // it holds its mean
  EXPECT_LT(single_interval(-0.3, 0.1, 16, Range::kPositive).high, 0.0);
  const Interval share = mean_interval({{0.0, 0.9, 1.0}}, Range::kShare);
  EXPECT_EQ(share.low, 0.0);
  EXPECT_EQ(share.high, 1.0);
}

TEST(MeanInterval, IsWiderByWhatReplicatesShare) {
  const std::vector<double> values = {1.0, 2.0, 3.0, 4.0};
  const Interval apart = mean_interval({values, 0.0}), shared = mean_interval({values, 0.2});
  // (1 + 3 / 5) / (1 - 1 / 5) = 2.
  EXPECT_NEAR(shared.standard_error, std::sqrt(2.0) * apart.standard_error, 1e-12);
  EXPECT_EQ(shared.mean, apart.mean);
  EXPECT_TRUE(std::isinf(mean_interval({values, 1.0}).high));
}

TEST(MeanInterval, OneValueHasNoInterval) {
  EXPECT_EQ(mean_interval({{3.0}}).mean, 3.0);
  EXPECT_NEAR(mean_interval({{3.0}}, Range::kPositive).mean, 3.0, 1e-15);
  EXPECT_TRUE(std::isnan(mean_interval({{3.0}}).low));
  EXPECT_TRUE(std::isnan(mean_interval({}).mean));
}

TEST(SingleInterval, OfAnErrorNeverReachesZero) {
  const Interval found = single_interval(0.5, 0.4, 5, Range::kPositive);
  EXPECT_DOUBLE_EQ(found.mean, 0.5);
  EXPECT_NEAR(found.low, 0.5 * std::exp(-2.7764451052 * 0.8 * std::sqrt(5.0 / 4.0)), 1e-9);
  EXPECT_TRUE(std::isnan(single_interval(0.5, std::nan(""), 1).low));
}

// Means of few blocks of normal pixels, with the error that resampling them gives.
TEST(SingleInterval, OfFewBlocksHoldsAsOftenAsOfMany) {
  for (const int blocks : {2, 4, 16}) {
    int held = 0;
    for (std::uint64_t seed = 0; seed < 1000; ++seed) {
      double sum = 0.0, squares = 0.0;
      for (unsigned b = 0; b < static_cast<unsigned>(blocks); ++b) {
        const double block = test::normal(seed, b);
        sum += block / blocks;
        squares += block * block / blocks;
      }
      const double of_resamples = std::sqrt(std::max(0.0, squares - sum * sum) / blocks);
      const Interval found = single_interval(sum, of_resamples, blocks);
      held += found.low <= 0.0 && 0.0 <= found.high;
    }
    EXPECT_NEAR(held, 950, 4 * 7) << blocks;
  }
}

TEST(MeanOfIntervals, IsGeometricAndKnowsItsFreedom) {
  Interval a = mean_interval({{1.0, 2.0, 4.0}}, Range::kPositive);
  const Interval both[] = {a, a};
  const Interval found = mean_of_intervals(both);
  EXPECT_NEAR(found.mean, a.mean, 1e-12);
  EXPECT_NEAR(found.standard_error, a.standard_error / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(found.freedom, 4.0, 1e-12);
  const Interval mixed[] = {a, mean_interval({{-1.0, 2.0}})};
  EXPECT_TRUE(std::isnan(mean_of_intervals(mixed).mean));
}

// 4000 intervals over 5 normal values, and over lognormal ones, whose mean of logarithms is known:
// 95 % +- 4 standard errors of the share.
TEST(MeanInterval, CoversTheMeanInNinetyFivePercent) {
  int normal = 0, lognormal = 0;
  for (std::uint64_t trial = 0; trial < 4000; ++trial) {
    Series values, exponentials;
    for (std::uint64_t i = 0; i < 5; ++i) {
      values.values.push_back(7.0 + 2.0 * test::normal(31, trial, i));
      exponentials.values.push_back(std::exp(values.values.back()));
    }
    const Interval real = mean_interval(values);
    normal += real.low <= 7.0 && 7.0 <= real.high;
    const Interval positive = mean_interval(exponentials, Range::kPositive);
    lognormal += positive.low <= std::exp(7.0) && std::exp(7.0) <= positive.high;
  }
  EXPECT_NEAR(normal / 4000.0, 0.95, 4 * std::sqrt(0.95 * 0.05 / 4000));
  EXPECT_EQ(normal, lognormal);
}

TEST(MeanError, OfAnInfiniteValueIsInfinite) {
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(mean_error(std::vector{1.0, infinite, 2.0}, 0.0).mean, infinite);
  EXPECT_TRUE(std::isnan(mean_error(std::vector{1.0, infinite, 2.0}, 0.0).standard_error));
  EXPECT_TRUE(std::isnan(mean_error(std::vector{infinite, -infinite}, 0.0).mean));
  // Of three recordings one has no finite value at all.
  EXPECT_EQ(mean_error(std::vector{1.0, 2.0, infinite}, 0.0, {}, 3).mean, infinite);
  EXPECT_FALSE((Series{{1.0, 1.0, infinite}}).alike());
}

}  // namespace
}  // namespace spool
