#include "lib/evaluation/intervals.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/random_images.h"

namespace spool {
namespace {

TEST(StudentQuantile, AgreesWithClosedFormsAndTables) {
  // One degree of freedom: tan(pi (p - 1/2)); two: closed form; the rest from printed tables.
  EXPECT_NEAR(student_quantile(0.975, 1), 12.7062047361747, 1e-9);
  EXPECT_NEAR(student_quantile(0.975, 2), 4.30265272974946, 1e-10);
  EXPECT_NEAR(student_quantile(0.975, 4), 2.77644510519779, 1e-10);
  EXPECT_NEAR(student_quantile(0.975, 9), 2.26215716279820, 1e-10);
  EXPECT_NEAR(student_quantile(0.995, 30), 2.74999565356722, 1e-10);
  EXPECT_NEAR(student_quantile(0.975, 1e7), 1.95996421, 1e-6);
  EXPECT_EQ(student_quantile(0.5, 3), 0.0);
  EXPECT_DOUBLE_EQ(student_quantile(0.1, 5), -student_quantile(0.9, 5));
}

TEST(StudentQuantile, InvertsTheDistribution) {
  for (const double freedom : {1.0, 2.5, 7.0, 40.0}) {
    for (const double p : {0.001, 0.2, 0.5, 0.77, 0.9999})
      EXPECT_NEAR(student_cdf(student_quantile(p, freedom), freedom), p, 1e-12);
  }
}

TEST(MeanInterval, ByHand) {
  const std::vector<double> values = {1.0, 2.0, 3.0, 4.0, std::nan("")};
  const Interval interval = mean_interval(values);
  EXPECT_EQ(interval.n, 4);
  EXPECT_DOUBLE_EQ(interval.mean, 2.5);
  EXPECT_DOUBLE_EQ(interval.standard_error, std::sqrt(5.0 / 3.0 / 4.0));
  EXPECT_NEAR(interval.high - 2.5, 3.18244630528371 * interval.standard_error, 1e-9);
}

TEST(MeanInterval, OneValueHasNoInterval) {
  const std::vector<double> one = {3.0};
  EXPECT_EQ(mean_interval(one).mean, 3.0);
  EXPECT_TRUE(std::isnan(mean_interval(one).low));
  EXPECT_TRUE(std::isnan(mean_interval({}).mean));
}

// 4000 intervals over 5 normal values: 95 % +- 4 standard errors of the share.
TEST(MeanInterval, CoversTheMeanInNinetyFivePercent) {
  int covered = 0;
  for (std::uint64_t trial = 0; trial < 4000; ++trial) {
    std::vector<double> values;
    for (std::uint64_t i = 0; i < 5; ++i)
      values.push_back(7.0 + 2.0 * test::normal(31, trial, i));
    const Interval interval = mean_interval(values);
    covered += interval.low <= 7.0 && 7.0 <= interval.high;
  }
  EXPECT_NEAR(covered / 4000.0, 0.95, 4 * std::sqrt(0.95 * 0.05 / 4000));
}

TEST(PairedDifference, CancelsWhatBothShare) {
  std::vector<double> a, b;
  for (std::uint64_t i = 0; i < 6; ++i) {
    a.push_back(100.0 * test::normal(1, i) + 1.0);
    b.push_back(a.back() - 1.0);
  }
  const Interval difference = paired_difference(a, b);
  EXPECT_NEAR(difference.mean, 1.0, 1e-12);
  EXPECT_LT(difference.standard_error, 1e-12);
}

}  // namespace
}  // namespace spool
