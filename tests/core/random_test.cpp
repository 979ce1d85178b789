#include "lib/core/random.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace spool {
namespace {

// Upper bound of a chi-square variable at significance 1e-5 [WilsonHilferty31].
double chi_square_bound(double freedom) {
  const double a = 2.0 / (9.0 * freedom);
  return freedom * std::pow(1.0 - a + 4.265 * std::sqrt(a), 3.0);
}

TEST(Random, SplitmixGivesThePublishedSequence) {
  // First outputs for seed 0; the state advances by the golden gamma.
  EXPECT_EQ(splitmix64(0), 0xE220A8397B1DCDAFull);
  EXPECT_EQ(splitmix64(0x9E3779B97F4A7C15ull), 0x6E789E6AA1B965F4ull);
}

TEST(Random, EveryWordOfMixMatters) {
  EXPECT_NE(mix(1, 2, 3), mix(2, 2, 3));
  EXPECT_NE(mix(1, 2, 3), mix(1, 3, 3));
  EXPECT_NE(mix(1, 2, 3), mix(1, 2, 4));
  EXPECT_NE(mix(1, 2, 3), mix(1, 3, 2));
  EXPECT_NE(mix(1, 2), mix(1, 2, 0));
}

TEST(Random, UnitDoubleIsBelowOneAndUniform) {
  EXPECT_LT(unit_double(~0ull), 1.0);
  EXPECT_EQ(unit_double(0), 0.0);
  std::vector<double> bins(64, 0.0);
  const int n = 64000;
  for (int i = 0; i < n; ++i)
    bins[static_cast<std::size_t>(64 * unit_double(mix(3, i)))] += 1;
  double chi_square = 0.0;
  for (const double b : bins)
    chi_square += (b - 1000) * (b - 1000) / 1000;
  EXPECT_LT(chi_square, chi_square_bound(63));
}

TEST(PermuteIndex, IsABijectionForEverySizeUpTo300) {
  for (std::uint32_t n = 1; n <= 300; ++n) {
    for (std::uint64_t key = 0; key < 5; ++key) {
      std::vector<bool> hit(n, false);
      for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t j = permute_index(i, n, mix(key, n));
        ASSERT_LT(j, n);
        ASSERT_FALSE(hit[j]) << "n " << n << " key " << key;
        hit[j] = true;
      }
    }
  }
}

TEST(PermuteIndex, IsABijectionOfLargeSizes) {
  for (const std::uint32_t n : {1023u, 4096u, 65535u, 65536u}) {
    std::vector<bool> hit(n, false);
    for (std::uint32_t i = 0; i < n; ++i)
      hit[permute_index(i, n, 17)] = true;
    for (std::uint32_t j = 0; j < n; ++j)
      ASSERT_TRUE(hit[j]);
  }
}

TEST(PermuteIndex, EveryPlaceIsEquallyLikelyForEveryIndex) {
  for (const std::uint32_t n : {2u, 3u, 5u, 8u, 16u, 17u, 64u}) {
    const int trials = 400 * static_cast<int>(n);
    double chi_square = 0.0;
    for (std::uint32_t i = 0; i < n; ++i) {
      std::vector<double> at(n, 0.0);
      for (int t = 0; t < trials; ++t)
        at[permute_index(i, n, mix(n, t))] += 1;
      for (const double count : at)
        chi_square += (count - 400) * (count - 400) / 400;
    }
    // n rows of n - 1 degrees of freedom each; columns sum to a constant too: (n - 1)^2.
    EXPECT_LT(chi_square, chi_square_bound((n - 1.0) * (n - 1.0)) * n / (n - 1.0)) << n;
  }
}

// Which samples fall into a prefix together decides the variance of replicates: pairs of places
// must be uniform as well as single ones.
TEST(PermuteIndex, EveryPairOfPlacesIsEquallyLikely) {
  for (const std::uint32_t n : {3u, 4u, 5u, 8u, 12u, 16u, 24u, 64u}) {
    const double pairs = n * (n - 1.0);
    const int trials = static_cast<int>(100 * pairs);
    for (const auto& [a, b] : {std::pair{0u, 1u}, std::pair{0u, n - 1}, std::pair{1u, n / 2 + 1}}) {
      if (a == b || b >= n) continue;
      std::vector<double> at(n * n, 0.0);
      for (int t = 0; t < trials; ++t) {
        const std::uint64_t key = mix(5, n, t);
        at[permute_index(a, n, key) * n + permute_index(b, n, key)] += 1;
      }
      double chi_square = 0.0;
      for (std::uint32_t i = 0; i < n; ++i) {
        for (std::uint32_t j = 0; j < n; ++j) {
          if (i != j) chi_square += (at[i * n + j] - 100) * (at[i * n + j] - 100) / 100;
        }
      }
      EXPECT_LT(chi_square, chi_square_bound(pairs - 1)) << n << ": " << a << ", " << b;
    }
  }
}

TEST(PermuteIndex, EveryPermutationOfFourIsEquallyLikely) {
  std::vector<double> at(256, 0.0);
  const int trials = 24 * 1000;
  for (int t = 0; t < trials; ++t) {
    std::size_t code = 0;
    for (std::uint32_t i = 0; i < 4; ++i)
      code = code * 4 + permute_index(i, 4, mix(11, t));
    at[code] += 1;
  }
  double chi_square = 0.0, seen = 0.0;
  for (const double count : at) {
    if (count > 0) chi_square += (count - 1000) * (count - 1000) / 1000, ++seen;
  }
  EXPECT_EQ(seen, 24.0);
  EXPECT_LT(chi_square, chi_square_bound(23));
}

}  // namespace
}  // namespace spool
