#include "lib/statistics/variance_of_mean.h"

#include <gtest/gtest.h>

#include "lib/core/parallel.h"
#include "lib/statistics/contrast.h"
#include "tests/reference/statistics_reference.h"
#include "tests/statistics/statistics_cases.h"

namespace spool {
namespace {

using test::memory_pool;
using test::uneven_counts;
using test::wild_radiance;

TEST(VarianceOfMean, EqualsTheTwinInEveryModeAndForSparseCounts) {
  const SamplePool pool = memory_pool(31, 19, 8, wild_radiance);
  CountImage sparse(31, 19), ones(31, 19, 1), one_pair(31, 19, 1);
  one_pair(30, 0) = 2;
  for (std::size_t i = 0; i < sparse.size(); ++i)
    sparse[i] = mix(8, i) % 60 == 0 ? 3 : (i % 3 == 0 ? 1 : 0);
  for (const CountImage& counts : {uneven_counts(31, 19, 8), sparse, ones, one_pair}) {
    const PieceStatistics s = prefix_statistics(pool, counts);
    for (const VarianceMode mode :
         {VarianceMode::kAuto, VarianceMode::kRaw, VarianceMode::kPooled}) {
      VarianceOptions options;
      options.mode = mode;
      options.scale = 0.5;
      GuardCounts guards;
      const Plane v = variance_of_mean(s.n, s.mean[1], s.m2[1], options, guards);
      for (int y = 0; y < 19; ++y) {
        for (int x = 0; x < 31; ++x) {
          const double slow =
              reference::variance_of_mean_at(s.n, s.mean[1], s.m2[1], options, x, y);
          if (std::isinf(slow)) {
            EXPECT_EQ(v(x, y), slow);
          } else {
            EXPECT_NEAR(v(x, y), slow, 1e-12 * slow) << x << "," << y;
          }
        }
      }
    }
  }
}

TEST(VarianceOfMean, FloorIsCountedAndKeepsBlackPiecesPositive) {
  const SamplePool pool = memory_pool(4, 4, 8, [](int, int, int) -> Rgb { return {}; });
  const PieceStatistics s = prefix_statistics(pool, CountImage(4, 4, 8));
  GuardCounts guards;
  const Plane v = variance_of_mean(s.n, s.mean[0], s.m2[0], {}, guards);
  EXPECT_EQ(guards[Guard::kVarianceFloor], 16u);
  for (const double value : v.pixels())
    EXPECT_DOUBLE_EQ(value, 1e-18);
}

// s^2 / n averages to the variance of the mean: 4000 pieces, 5 samples each, significance 6e-5.
TEST(VarianceOfMean, RawIsUnbiased) {
  const SamplePool pool = memory_pool(80, 50, 5, [](int x, int y, int s) -> Rgb {
    const auto v = static_cast<float>(unit_double(mix(4, x, y, s)));
    return {v, v * v, v < 0.1f ? 1.0f : 0.0f};
  });
  const PieceStatistics statistics = prefix_statistics(pool, CountImage(80, 50, 5));
  const double truth[] = {1.0 / 12, 1.0 / 5 - 1.0 / 9, 0.09};
  VarianceOptions raw;
  raw.mode = VarianceMode::kRaw;
  for (std::size_t c = 0; c < 3; ++c) {
    GuardCounts guards;
    const Plane v =
        variance_of_mean(statistics.n, statistics.mean[c], statistics.m2[c], raw, guards);
    const reference::ScalarSummary all =
        reference::summary(std::vector<double>(v.pixels().begin(), v.pixels().end()));
    const double standard_error = std::sqrt(all.m2 / 3999 / 4000);
    EXPECT_LT(std::abs(all.mean - truth[c] / 5), 4 * standard_error) << c;
  }
}

// With one sample everywhere and a flat image, neighbours tell the variance: half the mean squared
// difference.
TEST(VarianceOfMean, OneSampleEverywhereLearnsFromNeighbours) {
  const SamplePool pool = memory_pool(100, 100, 1, [](int x, int y, int) -> Rgb {
    const auto v = static_cast<float>(unit_double(mix(14, x, y)));
    return {v, v, v};
  });
  const PieceStatistics s = prefix_statistics(pool, CountImage(100, 100, 1));
  GuardCounts guards;
  const Plane v = variance_of_mean(s.n, s.mean[0], s.m2[0], {}, guards);
  EXPECT_NEAR(v(50, 50), 1.0 / 12, 0.05 / 12);
  EXPECT_EQ(v(0, 0), v(99, 99));
}

TEST(VarianceOfMean, BitsDoNotDependOnTheNumberOfThreads) {
  const SamplePool pool = memory_pool(50, 40, 4, wild_radiance);
  const PieceStatistics s = prefix_statistics(pool, uneven_counts(50, 40, 4));
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    GuardCounts guards;
    return analysis_variance(s, {}, guards);
  };
  const Plane once = run(1);
  EXPECT_EQ(run(2), once);
  EXPECT_EQ(run(7), once);
}

TEST(Contrast, GuardedIsBetweenZeroAndOneForAnyExtremes) {
  GuardCounts guards;
  const double values[] = {-1e30, -1.0, -0.0999, -1e-30, 0.0, 1e-30, 0.1, 1.0, 1e30};
  for (const double low : values) {
    for (const double high : values) {
      if (low > high) continue;
      const double c = squared_contrast(low, high, ContrastForm::kGuarded, guards);
      EXPECT_GE(c, 0.0);
      EXPECT_LE(c, 1.0) << low << " " << high;
    }
  }
}

TEST(Contrast, FormsAgreeForPositiveSamplesUpToTheEpsilon) {
  GuardCounts guards;
  for (const double low : {0.01, 0.5, 2.0}) {
    for (const double ratio : {1.0, 1.5, 10.0, 1000.0}) {
      const double literal = squared_contrast(low, low * ratio, ContrastForm::kLiteral, guards);
      const double guarded = squared_contrast(low, low * ratio, ContrastForm::kGuarded, guards);
      EXPECT_LE(guarded, literal);
      EXPECT_GE(guarded, literal * (1.0 - 2.0 * kContrastEpsilon / low));
    }
  }
  EXPECT_DOUBLE_EQ(squared_contrast(1.0, 3.0, ContrastForm::kLiteral, guards), 0.25);
}

TEST(Contrast, LiteralIsZeroAndCountedWhereItIsNotDefined) {
  GuardCounts guards;
  EXPECT_EQ(squared_contrast(-1.0, 1.0, ContrastForm::kLiteral, guards), 0.0);
  EXPECT_EQ(squared_contrast(0.0, 0.0, ContrastForm::kLiteral, guards), 0.0);
  EXPECT_EQ(guards[Guard::kContrastUndefined], 2u);
}

}  // namespace
}  // namespace spool
