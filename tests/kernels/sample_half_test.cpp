// The halves that dual-buffer filters compare: counts, means, and where their variances come from.
#include "lib/kernels/sample_half.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/statistics/piece_statistics.h"
#include "tests/reference/test_images.h"
#include "tests/support/memory_pool.h"

namespace spool {
namespace {

constexpr double kExposure = 2.5;

SamplePool noisy_pool() {
  return test::memory_pool(9, 7, 12, [](int x, int y, int s) {
    const auto value = static_cast<float>((1.0 + x) * unit_double(mix(4, x, y, s)));
    return Rgb{value, 0.5f * value, value + 1.0f};
  });
}

PieceStatistics statistics_of(const SamplePool& pool, int least) {
  CountImage n(pool.width(), pool.height());
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x)
      n(x, y) = least + (x + 2 * y) % 5;
  }
  return prefix_statistics(pool, n);
}

// In plain loops: sample variance of `count` samples from `first` on, `step` apart.
double sample_variance(const SamplePool& pool, int x, int y, std::size_t c, int first, int step,
                       int end) {
  double mean = 0.0, squares = 0.0;
  int count = 0;
  for (int s = first; s < end; s += step, ++count)
    mean += static_cast<double>(pool.sample(x, y, s)[c]);
  mean /= count;
  for (int s = first; s < end; s += step)
    squares += std::pow(static_cast<double>(pool.sample(x, y, s)[c]) - mean, 2);
  return squares / (count - 1);
}

TEST(SampleHalf, VarianceIsOfAllSamplesOfThePieceOverTheCountOfTheHalf) {
  const SamplePool pool = noisy_pool();
  const PieceStatistics statistics = statistics_of(pool, 2);
  for (const int parity : {0, 1}) {
    const auto half = sample_half(statistics, pool, parity, HalfVariance::kBoth, kExposure);
    ASSERT_TRUE(half.has_value());
    for (int y = 0; y < pool.height(); ++y) {
      for (int x = 0; x < pool.width(); ++x) {
        const int n = statistics.n(x, y), own = (n + 1 - parity) / 2;
        ASSERT_EQ(half->n(x, y), own);
        for (std::size_t c = 0; c < 3; ++c) {
          const double expected =
              kExposure * kExposure * sample_variance(pool, x, y, c, 0, 1, n) / own;
          ASSERT_NEAR(half->image.variance[c](x, y), expected, 1e-12 * expected + 1e-15);
        }
      }
    }
  }
}

TEST(SampleHalf, VarianceIsOfItsOwnSamplesWhenAskedFor) {
  const SamplePool pool = noisy_pool();
  const PieceStatistics statistics = statistics_of(pool, 4);
  for (const int parity : {0, 1}) {
    const auto half = sample_half(statistics, pool, parity, HalfVariance::kRaw, kExposure);
    ASSERT_TRUE(half.has_value());
    const int x = 3, y = 5, n = statistics.n(x, y), own = (n + 1 - parity) / 2;
    for (std::size_t c = 0; c < 3; ++c) {
      const double expected =
          kExposure * kExposure * sample_variance(pool, x, y, c, parity, 2, n) / own;
      ASSERT_NEAR(half->image.variance[c](x, y), expected, 1e-12 * expected);
    }
  }
}

// Nothing is known of the spread of one sample but what its neighbours say; a dark piece beside
// bright ones with two samples or more keeps its own variance.
TEST(SampleHalf, ADarkPieceDoesNotTakeTheVarianceOfBrightNeighbours) {
  const SamplePool pool = test::memory_pool(7, 7, 4, [](int x, int, int s) {
    const float value = x < 3 ? 0.01f * static_cast<float>(1 + s % 2)
                              : 10.0f * static_cast<float>(unit_double(mix(2, x, s)));
    return Rgb{value, value, value};
  });
  const PieceStatistics statistics = prefix_statistics(pool, CountImage(7, 7, 4));
  const auto both = sample_half(statistics, pool, 0, HalfVariance::kBoth, 1.0);
  const auto pooled = sample_half(statistics, pool, 0, HalfVariance::kPooled, 1.0);
  ASSERT_TRUE(both.has_value() && pooled.has_value());
  EXPECT_LT(both->image.variance[0](2, 3), 1e-4);
  EXPECT_GT(pooled->image.variance[0](2, 3), 0.1);

  const auto single =
      sample_half(prefix_statistics(pool, CountImage(7, 7, 1)), pool, 0, HalfVariance::kBoth, 1.0);
  ASSERT_TRUE(single.has_value());
  EXPECT_GT(single->image.variance[0](2, 3), 0.1);
}

}  // namespace
}  // namespace spool
