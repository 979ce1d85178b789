// Mitchell, filtered halves, given counts and the oracle: laws and slow twins.
#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "lib/sampling/adaptive_wavelet.h"
#include "lib/sampling/filtered_halves.h"
#include "lib/sampling/given_counts.h"
#include "lib/sampling/mitchell.h"
#include "lib/sampling/neyman.h"
#include "lib/sampling/rounds.h"
#include "tests/reference/adaptive_wavelet_reference.h"
#include "tests/reference/mitchell_reference.h"
#include "tests/sampling/multiscale_cases.h"
#include "tests/support/scene_s.h"
#include "tests/support/sizes.h"

namespace spool {
namespace {

TEST(Rounds, EqualSharesSumUpAndDifferByOne) {
  for (const long long total : {0LL, 1LL, 7LL, 8LL, 1000003LL}) {
    const auto shares = equal_shares(total, 8);
    EXPECT_EQ(std::accumulate(shares.begin(), shares.end(), 0LL), total);
    EXPECT_LE(shares.front() - shares.back(), 1);
  }
}

void expect_counts_of_the_mitchell_twin(int width, int height) {
  const SamplePool colour = test::noisy_pool(width, height, 14);
  const SamplePool grey = test::scene_s_pool(std::min(height, 12), 14, 5);
  for (const OptionValues& set :
       std::vector<OptionValues>{{}, {{"rounds", "3"}, {"init_spp", "2"}}, {{"rounds", "1"}}}) {
    for (const SamplePool* pool : {&colour, &grey}) {
      const auto options = with_options(mitchell_option_table(), MitchellOptions{}, set);
      ASSERT_TRUE(options.has_value());
      const long long pieces = pool->width() * pool->height();
      for (const long long budget : {3 * pieces + 5, 9 * pieces, 13 * pieces + 1}) {
        const auto result = sample_mitchell(*pool, budget, *options, {});
        ASSERT_TRUE(result.has_value());
        const int each = options->init_spp.value_or(default_initial_samples(budget, *pool));
        const CountImage first(pool->width(), pool->height(), each);
        const std::array<double, 3> tau =
            pool == &grey ? std::array{0.4, 0.4, 0.4} : std::array{0.4, 0.3, 0.6};
        const CountImage expected =
            reference::mitchell(*pool, first, result->selection.statistics.signal.exposure,
                                budget - each * pieces, tau, options->rounds);
        EXPECT_EQ(result->selection.statistics.n, expected);
        EXPECT_EQ(result->log.spent, std::min(budget, pool->total_capacity()));
      }
    }
  }
}

TEST(Mitchell, CountsEqualThoseOfTheSlowTwin) {
  for (const auto& [width, height] : test::twin_sizes()) {
    SCOPED_TRACE(fmt::format("{} x {}", width, height));
    expect_counts_of_the_mitchell_twin(width, height);
  }
}

void expect_counts_of_the_wavelet_twin(int width, int height) {
  for (const OptionValues& set :
       std::vector<OptionValues>{{{"epochs", "7"}},
                                 {{"epochs", "1000000"}, {"levels", "2"}, {"init_spp", "2"}},
                                 {{"epochs", "5"}, {"priority", "absolute"}, {"init_spp", "3"}},
                                 {{"epochs", "4"}, {"levels", "0"}}}) {
    const auto options =
        with_options(adaptive_wavelet_option_table(), AdaptiveWaveletOptions{}, set);
    ASSERT_TRUE(options.has_value());
    const SamplePool pool = test::noisy_pool(width, height, 9);
    for (const long long budget :
         {4LL * width * height + 3, 8LL * width * height + std::min(100, width * height - 1)}) {
      const auto result = sample_adaptive_wavelet(pool, budget, *options, {});
      ASSERT_TRUE(result.has_value());
      const int each = options->init_spp.value_or(default_initial_samples(budget, pool));
      std::vector<long long> levels;
      const CountImage expected = reference::adaptive_wavelet(
          pool, CountImage(width, height, each), result->selection.statistics.signal,
          budget - each * width * height, *options, levels);
      EXPECT_EQ(result->selection.statistics.n, expected);
      // A lone piece is the block of every level: rounding decides which of them is popped.
      if (width * height > 1) {
        EXPECT_EQ(result->log.samples_of_level, levels);
      }
    }
  }
}

TEST(AdaptiveWavelet, CountsEqualThoseOfTheSlowTwin) {
  for (const auto& [width, height] : test::twin_sizes()) {
    SCOPED_TRACE(fmt::format("{} x {}", width, height));
    expect_counts_of_the_wavelet_twin(width, height);
  }
}

TEST(AdaptiveWavelet, BlackIsUniform) {
  const SamplePool black = test::memory_pool(20, 11, 8, [](int, int, int) { return Rgb{0, 0, 0}; });
  const auto dark = sample_adaptive_wavelet(black, 220 * 5, {}, {});
  ASSERT_TRUE(dark.has_value());
  for (const auto n : dark->selection.statistics.n.pixels())
    ASSERT_EQ(n, 5);
  EXPECT_EQ(dark->log.uniform_remainder, 220 * 3);
}

TEST(FilteredHalves, NeedsAFilterAndLooksAtNothingBeyondTheCursor) {
  const SamplePool pool = test::noisy_pool(10, 10, 12);
  EXPECT_EQ(sample_filtered_halves(pool, 600, {}, {}).error().code, ErrorCode::kUsage);
  int calls = 0;
  SamplingContext context;
  context.filter = [&](const Selection& half, const SamplePool& half_pool) -> Result<RgbImage> {
    ++calls;
    for (int y = 0; y < 10; ++y) {
      for (int x = 0; x < 10; ++x)
        EXPECT_LE(half.statistics.n(x, y), half_pool.capacity(x, y));
    }
    GuardCounts guards;
    return pixel_means(half.statistics, guards);
  };
  const auto result = sample_filtered_halves(pool, 600, {}, context);
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(calls, 8);
  EXPECT_EQ(result->log.spent, 600);
  const auto all = sample_filtered_halves(pool, 10000, {}, context);
  EXPECT_EQ(all->log.spent, 1200);
  EXPECT_EQ(all->log.saturated_pieces, 100);
}

TEST(PoolHalves, AreDisjointAndCoverThePool) {
  const auto recording = test::memory_recording(
      5, 4, 9, [](int x, int y, int s) { return test::varied_noise(5, x, y, s); });
  for (const PoolOrder order : {PoolOrder::kRecorded, PoolOrder::kShuffled}) {
    PoolOptions options;
    options.order = order;
    options.holdout = 2;
    const SamplePool pool = test::pool_of(recording, options);
    const SamplePool even = pool.half(0), odd = pool.half(1);
    EXPECT_EQ(even.capacity(2, 2), 4);
    EXPECT_EQ(odd.capacity(2, 2), 3);
    EXPECT_EQ(even.size(2, 2) + odd.size(2, 2), 9);
    for (int s = 0; s < 9; ++s)
      EXPECT_EQ(pool.recorded_index(2, 2, s),
                (s % 2 == 0 ? even : odd).recorded_index(2, 2, s / 2));
    const SamplePool quarter = odd.half(1);
    EXPECT_EQ(quarter.recorded_index(1, 1, 1), pool.recorded_index(1, 1, 7));
  }
}

TEST(GivenCounts, AreTakenAsTheyAreOrRefused) {
  const SamplePool pool = test::noisy_pool(6, 5, 4);
  CountImage counts(6, 5, 2);
  counts(1, 1) = 0;
  counts(2, 3) = 4;
  const auto take = [&](const CountImage& wanted) {
    return sample_given_counts(pool, 17, wanted, "mine.exr", {});
  };
  const auto result = take(counts);
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->selection.statistics.n, counts);
  EXPECT_EQ(result->log.budget, 17);
  EXPECT_EQ(result->log.spent, 60);
  counts(2, 3) = 5;
  EXPECT_EQ(take(counts).error().code, ErrorCode::kData);
  counts(2, 3) = -1;
  EXPECT_FALSE(take(counts).has_value());
  EXPECT_FALSE(take(CountImage(5, 6, 1)).has_value());
}

TEST(Neyman, CountsAreProportionalToTheDeviation) {
  const SamplePool pool = test::memory_pool(8, 8, 200, [](int x, int y, int s) {
    const auto u = static_cast<float>((x < 4 ? 1.0 : 3.0) * unit_double(mix(8, x, y, s)));
    return Rgb{u, u, u};
  });
  const auto result = sample_neyman(pool, 64 * 40, {}, {});
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->log.spent, 64 * 40);
  double low = 0.0, high = 0.0;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x)
      (x < 4 ? low : high) += result->selection.statistics.n(x, y);
  }
  EXPECT_NEAR(high / low, 3.0, 0.05);
}

TEST(Neyman, FlatPiecesKeepTheirFirstSampleAndCapsHold) {
  const SamplePool pool = test::memory_pool(4, 4, 6, [](int x, int y, int s) {
    const auto u = x == 0 ? static_cast<float>(unit_double(mix(8, x, y, s))) : 0.5f;
    return Rgb{u, u, u};
  });
  const auto result = sample_neyman(pool, 16 * 3, {}, {});
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->log.spent, 48);
  for (int y = 0; y < 4; ++y)
    EXPECT_EQ(result->selection.statistics.n(0, y), 6);
  for (const auto n : result->selection.statistics.n.pixels())
    EXPECT_GE(n, 1);
}

}  // namespace
}  // namespace spool
