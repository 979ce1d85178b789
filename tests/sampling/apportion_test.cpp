#include "lib/sampling/apportion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "lib/core/random.h"

namespace spool {
namespace {

using Shares = std::vector<long long>;
constexpr long long kNoCap = 1'000'000'000;

Shares uncapped(const std::vector<double>& weights, long long budget) {
  return apportion(weights, budget, Shares(weights.size(), kNoCap));
}

TEST(Apportion, WorkedExamples) {
  EXPECT_EQ(uncapped({3, 1, 1, 1}, 10), (Shares{5, 2, 2, 1}));
  EXPECT_EQ(uncapped({1, 0.6, 0.4}, 3), (Shares{1, 1, 1}));
  EXPECT_EQ(uncapped({0, 0, 0}, 7), (Shares{3, 2, 2}));
  EXPECT_EQ(uncapped({1, 0, 4}, 10), (Shares{2, 0, 8}));
  EXPECT_EQ(apportion(std::vector<double>{1, 1}, 10, Shares{2, 100}), (Shares{2, 8}));
  EXPECT_EQ(apportion(std::vector<double>{1, 0}, 10, Shares{4, 100}), (Shares{4, 6}));
  EXPECT_TRUE(uncapped({}, 5).empty());
  constexpr long long kLarge = 1'000'000'000'000;  // products beyond 64 bits
  EXPECT_EQ(apportion(std::vector<double>{4, 1}, 5 * kLarge, Shares{5 * kLarge, 5 * kLarge}),
            (Shares{4 * kLarge, kLarge}));
}

TEST(Apportion, OddWeightsCountAsTheHeaderSays) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(uncapped({nan, 1, -5}, 6), (Shares{0, 6, 0}));
  EXPECT_EQ(uncapped({inf, 2, 1}, 10), (Shares{4, 4, 2}));
  EXPECT_EQ(uncapped({inf, 0, inf}, 10), (Shares{5, 0, 5}));
  EXPECT_EQ(uncapped({1e-300, 1e300}, 10), (Shares{0, 10}));
}

// Sum exact, and caps kept.
TEST(Apportion, TwoThousandRandomCasesKeepSumAndCaps) {
  std::uint64_t counter = 0;
  const auto random = [&](std::uint64_t n) { return mix(7, counter++) % n; };
  for (int round = 0; round < 2000; ++round) {
    const std::size_t n = 1 + random(40);
    std::vector<double> weights(n);
    Shares caps(n);
    for (std::size_t t = 0; t < n; ++t) {
      weights[t] = random(4) == 0 ? 0.0
                                  : std::ldexp(unit_double(mix(8, counter++)),
                                               static_cast<int>(random(60)) - 30);
      caps[t] = random(5) == 0 ? 0 : static_cast<long long>(random(1000));
    }
    const auto budget = static_cast<long long>(random(20000));
    const Shares shares = apportion(weights, budget, caps);
    ASSERT_EQ(shares.size(), n);
    const long long capacity = std::accumulate(caps.begin(), caps.end(), 0LL);
    ASSERT_EQ(std::accumulate(shares.begin(), shares.end(), 0LL), std::min(budget, capacity));
    for (std::size_t t = 0; t < n; ++t) {
      ASSERT_GE(shares[t], 0);
      ASSERT_LE(shares[t], caps[t]);
    }
  }
}

// Of what those leave whose quota is their cap or more.
TEST(Apportion, EveryShareIsWithinOneOfItsQuota) {
  for (std::uint64_t round = 0; round < 500; ++round) {
    const std::size_t n = 1 + mix(9, round) % 30;
    std::vector<double> weights(n);
    Shares caps(n, kNoCap);
    for (std::size_t t = 0; t < n; ++t) {
      weights[t] = 0.01 + unit_double(mix(10, round, t));
      if (round % 2 == 1) caps[t] = static_cast<long long>(mix(12, round, t) % 2000);
    }
    const auto budget = static_cast<long long>(mix(11, round) % 20000);
    const Shares shares = apportion(weights, budget, caps);
    const auto quotas = [&](const std::vector<bool>& full) {
      double sum = 0.0, open = static_cast<double>(budget);
      for (std::size_t t = 0; t < n; ++t)
        full[t] ? open -= static_cast<double>(caps[t]) : sum += weights[t];
      std::vector<double> quota;
      for (std::size_t t = 0; t < n; ++t)
        quota.push_back(full[t] ? static_cast<double>(caps[t]) : weights[t] / sum * open);
      return quota;
    };
    std::vector<bool> full(n, false), before;
    while (full != before) {
      before = full;
      const std::vector<double> quota = quotas(before);
      for (std::size_t t = 0; t < n; ++t)
        full[t] = before[t] || quota[t] >= static_cast<double>(caps[t]);
    }
    const std::vector<double> quota = quotas(full);
    for (std::size_t t = 0; t < n; ++t) {
      // 1e-3: weights round to 2^-32.
      ASSERT_NEAR(static_cast<double>(shares[t]), quota[t], full[t] ? 0.0 : 1.0 + 1e-3) << round;
    }
  }
}

TEST(Apportion, HugeBudgetsDoNotOverflow) {
  const long long budget = std::numeric_limits<long long>::max() / 4;
  const Shares caps(3, budget);
  const Shares shares = apportion(std::vector<double>{1, 1, 2}, budget, caps);
  EXPECT_EQ(std::accumulate(shares.begin(), shares.end(), 0LL), budget);
  EXPECT_LE(std::abs(shares[0] - budget / 4), 2);
}

}  // namespace
}  // namespace spool
