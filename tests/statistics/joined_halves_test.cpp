#include "lib/statistics/joined_halves.h"

#include <set>

#include <gtest/gtest.h>

#include "tests/support/memory_pool.h"

namespace spool {
namespace {

constexpr int kWidth = 6, kHeight = 5, kSamples = 15;

SamplePool pool() {
  return test::pool_of(test::memory_recording(kWidth, kHeight, kSamples, [](int x, int y, int s) {
    const auto v = static_cast<float>(unit_double(mix(9, x, y, s)));
    return Rgb{v, v * v, 3 * v};
  }));
}

// Counts that meet every order of the two, none and all of a half.
CountImage counts(int parity) {
  CountImage n(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x)
      n(x, y) = parity == 0 ? std::min(8, 2 * x) : std::min(7, 2 * y);
  }
  return n;
}

Selection joined(const SamplePool& of) {
  return join_halves(of, {{prefix_statistics(of.half(0), counts(0)), {}},
                          {prefix_statistics(of.half(1), counts(1)), {}}});
}

void expect_union_first(const SamplePool& of, const SamplePool& ordered, int size) {
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const int a = std::min(counts(0)(x, y), of.half(0).size(x, y));
      const int b = std::min(counts(1)(x, y), of.half(1).size(x, y));
      std::set<int> wanted, first, all;
      for (int i = 0; i < a; ++i)
        wanted.insert(of.half(0).recorded_index(x, y, i));
      for (int i = 0; i < b; ++i)
        wanted.insert(of.half(1).recorded_index(x, y, i));
      for (int i = 0; i < size; ++i) {
        if (i < a + b) first.insert(ordered.recorded_index(x, y, i));
        all.insert(ordered.recorded_index(x, y, i));
      }
      EXPECT_EQ(first, wanted) << x << "," << y;
      EXPECT_EQ(all.size(), static_cast<std::size_t>(size)) << x << "," << y;
      EXPECT_EQ(ordered.capacity(x, y), of.capacity(x, y));
      EXPECT_EQ(ordered.half(1).recorded_index(x, y, 1), ordered.recorded_index(x, y, 3));
    }
  }
}

TEST(JoinedHalves, StatisticsMadeAgainOfTheirSamplesAreTheSame) {
  const SamplePool whole = pool();
  const Selection selection = joined(whole);
  const SamplePool first = pool_of_joined(whole, selection);
  PieceStatistics again = prefix_statistics(first, selection.statistics.n);
  weigh_halves_alike(again, first, counts(0), counts(1));
  for (std::size_t i = 0; i < again.n.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(again.mean[c][i], selection.statistics.mean[c][i], 1e-14);
      EXPECT_NEAR(again.m2[c][i], selection.statistics.m2[c][i], 1e-12);
    }
    EXPECT_NEAR(again.analysis.mean[i], selection.statistics.analysis.mean[i], 1e-14);
    EXPECT_NEAR(again.analysis.m2[i], selection.statistics.analysis.m2[i], 1e-12);
  }
}

TEST(JoinedHalves, AreTheFirstSamplesOfTheirPool) {
  const SamplePool whole = pool();
  expect_union_first(whole, whole.with_halves_first(counts(0), counts(1)), kSamples);
  EXPECT_FALSE(whole.with_halves_first(counts(0), counts(1)).is_half());

  const auto longer = test::memory_recording(kWidth, kHeight, 2 * kSamples, [](int, int, int s) {
    return Rgb{static_cast<float>(s), 0, 0};
  });
  PoolOptions options;
  options.order = PoolOrder::kShuffled;
  options.seed = 3;
  const SamplePool half = test::pool_of(longer, options).half(1);
  expect_union_first(half, half.with_halves_first(counts(0), counts(1)), kSamples);
  EXPECT_TRUE(half.with_halves_first(counts(0), counts(1)).is_half());
}

TEST(JoinedHalves, HaveTheMeanOfBothMeansAndItsVariance) {
  const SamplePool whole = pool();
  const Selection selection = joined(whole);
  const SamplePool ordered = pool_of_joined(whole, selection);
  const PieceStatistics all = prefix_statistics(ordered, selection.statistics.n);
  for (std::size_t i = 0; i < all.n.size(); ++i) {
    const double a = counts(0)[i], b = counts(1)[i], n = a + b;
    ASSERT_EQ(selection.statistics.n[i], n);
    for (std::size_t c = 0; c < 3; ++c) {
      const double mean = selection.statistics.mean[c][i], m2 = selection.statistics.m2[c][i];
      if (a == 0 || b == 0) {
        EXPECT_EQ(mean, all.mean[c][i]);
        EXPECT_EQ(m2, all.m2[c][i]);
        continue;
      }
      EXPECT_DOUBLE_EQ(mean, 0.5 * (selection.halves[0].statistics.mean[c][i] +
                                    selection.halves[1].statistics.mean[c][i]));
      const double sample_variance = all.m2[c][i] / (n - 1);
      EXPECT_NEAR(m2 / ((n - 1) * n), sample_variance * (1 / a + 1 / b) / 4,
                  1e-12 * sample_variance);
      if (a == b) {
        EXPECT_EQ(m2, all.m2[c][i]);
      }
    }
  }
}

TEST(JoinedHalves, SayWhatWasLookedAt) {
  const SamplePool whole = pool();
  const Selection selection = joined(whole);
  const CountImage n = looked_at(selection);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      int last = 0;
      for (int i = 0; i < counts(0)(x, y); ++i)
        last = std::max(last, 2 * i + 1);
      for (int i = 0; i < counts(1)(x, y); ++i)
        last = std::max(last, 2 * i + 2);
      EXPECT_EQ(n(x, y), last);
    }
  }
  const Selection plain{prefix_statistics(whole, counts(0)), {}};
  EXPECT_EQ(looked_at(plain), counts(0));
}

}  // namespace
}  // namespace spool
