#include "lib/sampling/uniform.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "lib/core/random.h"
#include "tests/support/memory_pool.h"

namespace spool {
namespace {

Rgb noise(int x, int y, int s) {
  const auto value = [&](int c) {
    return static_cast<float>(unit_double(mix(1, x, y, s, c)) * (1 + x));
  };
  return {value(0), value(1), value(2)};
}

TEST(Uniform, WholeBudgetGivesTheSameCountEverywhere) {
  const SamplePool pool = test::memory_pool(7, 5, 8, noise);
  const auto result = sample_uniform(pool, 35 * 3, {}, {});
  ASSERT_TRUE(result.has_value());
  for (const auto n : result->selection.statistics.n.pixels())
    EXPECT_EQ(n, 3);
  EXPECT_EQ(result->log.spent, 105);
  EXPECT_EQ(result->log.saturated_pieces, 0);
}

TEST(Uniform, FractionalBudgetIsSpentExactlyAndCountsDifferByOne) {
  const SamplePool pool = test::memory_pool(13, 11, 8, noise);
  for (long long budget = 0; budget <= 13 * 11 * 8; budget += 17) {
    const auto result = sample_uniform(pool, budget, {}, {});
    ASSERT_TRUE(result.has_value());
    const auto n = result->selection.statistics.n.pixels();
    const auto [low, high] = std::minmax_element(n.begin(), n.end());
    EXPECT_LE(*high - *low, 1) << budget;
    EXPECT_EQ(test::total(result->selection.statistics.n), budget);
    EXPECT_EQ(result->log.spent, budget);
  }
}

TEST(Uniform, RemainderIsSpreadOverTheImage) {
  const SamplePool pool = test::memory_pool(64, 64, 4, noise);
  const auto result = sample_uniform(pool, 64 * 64 + 1024, {}, {});
  ASSERT_TRUE(result.has_value());
  // A quarter of 1024 in each quadrant; 5 standard deviations of the hypergeometric count is 64.
  for (int quadrant = 0; quadrant < 4; ++quadrant) {
    long long extra = 0;
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 32; ++x) {
        extra +=
            result->selection.statistics.n(x + 32 * (quadrant % 2), y + 32 * (quadrant / 2)) - 1;
      }
    }
    EXPECT_NEAR(static_cast<double>(extra), 256.0, 64.0);
  }
}

TEST(Uniform, ShortPiecesHandTheirShareOn) {
  SanitiseRules rules;
  rules.allow_many_rejected = true;
  const SamplePool pool = test::memory_pool(
      4, 1, 8,
      [](int x, int, int s) {
        if (x == 1 && s >= 2) return Rgb{std::numeric_limits<float>::quiet_NaN(), 0, 0};
        return Rgb{1, 1, 1};
      },
      rules);
  const auto result = sample_uniform(pool, 20, {}, {});
  ASSERT_TRUE(result.has_value());
  const CountImage& n = result->selection.statistics.n;
  EXPECT_EQ(n(1, 0), 2);
  EXPECT_EQ(n(0, 0), 6);
  EXPECT_EQ(n(2, 0), 6);
  EXPECT_EQ(n(3, 0), 6);
  EXPECT_EQ(result->log.saturated_pieces, 1);
  EXPECT_EQ(result->log.guards[Guard::kSaturatedPieces], 1u);
}

TEST(Uniform, BudgetBeyondThePoolIsReported) {
  const SamplePool pool = test::memory_pool(5, 3, 4, noise);
  const auto result = sample_uniform(pool, 1000, {}, {});
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->log.budget, 1000);
  EXPECT_EQ(result->log.spent, 60);
  EXPECT_EQ(result->log.saturated_pieces, 15);
}

TEST(Uniform, ExposureBringsTheMeanToOne) {
  const SamplePool pool = test::memory_pool(9, 9, 4, [](int, int, int) { return Rgb{4, 4, 4}; });
  const auto result = sample_uniform(pool, 81 * 2, {}, {});
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->selection.statistics.signal.exposure, 0.25, 1e-15);
  EXPECT_NEAR(result->selection.statistics.analysis.mean(4, 4), 1.0, 1e-14);
  EXPECT_EQ(result->selection.statistics.mean[0](4, 4), 4.0);
}

TEST(RaiseLeastSampled, FillsTheLowestFirstInsideTheAreaOnly) {
  const SamplePool pool = test::memory_pool(4, 2, 8, noise);
  CountImage n(4, 2, 5);
  n(1, 0) = 2;
  n(2, 0) = 3;
  n(3, 1) = 0;  // outside the area
  const CountImage raised = raise_least_sampled(n, pool, {0, 0, 4, 1}, 3, 1);
  ASSERT_EQ(raised.height(), 1);
  EXPECT_EQ(raised(1, 0) + raised(2, 0), 8);
  EXPECT_EQ(std::max(raised(1, 0), raised(2, 0)), 4);
  EXPECT_EQ(raised(0, 0), 5);
  EXPECT_EQ(raised(3, 0), 5);
  const CountImage limited = raise_least_sampled(n, pool, {0, 0, 4, 1}, 100, 1, 5);
  for (const auto count : limited.pixels())
    EXPECT_EQ(count, 5);
}

}  // namespace
}  // namespace spool
