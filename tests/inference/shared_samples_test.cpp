#include "lib/inference/shared_samples.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "lib/core/radical_inverse.h"
#include "lib/core/random.h"

namespace spool {
namespace {

// Of 64 recorded samples.
TakenSamples taken(TakenCounts counts, double rare = 1.0) {
  return {std::move(counts), 64, rare};
}

TEST(RadicalInverse, HalvesTheGapsInTurn) {
  const double first[] = {0.0, 0.5, 0.25, 0.75, 0.125, 0.625, 0.375, 0.875};
  for (unsigned i = 0; i < 8; ++i)
    EXPECT_EQ(radical_inverse(i), first[i]);
}

TEST(SharedByReplicates, IsNoneWhereReplicatesFitInBesideEachOther) {
  EXPECT_EQ(shared_by_replicates(taken({{8, 100}}), pairs_of(8), Taking::kOneAround).samples, 0.0);
  EXPECT_EQ(shared_by_replicates(taken({{8, 100}}), pairs_of(8), Taking::kOneAround).correlation,
            0.0);
  EXPECT_EQ(shared_by_replicates(taken({{8, 100}}), pairs_of(1), Taking::kOwnOrder).samples, 0.0);
  EXPECT_GT(shared_by_replicates(taken({{9, 100}}), pairs_of(8), Taking::kOneAround).samples, 0.0);
}

TEST(SharedByReplicates, OfOwnOrdersIsTheShareTaken) {
  EXPECT_DOUBLE_EQ(shared_by_replicates(taken({{16, 100}}), pairs_of(8), Taking::kOwnOrder).samples,
                   0.25);
  // Every pixel that was sampled counts once, however many samples it took.
  const TakenSamples several = taken({{0, 5}, {4, 3}, {64, 1}});
  EXPECT_DOUBLE_EQ(shared_by_replicates(several, pairs_of(8), Taking::kOwnOrder).samples,
                   (3 * 4.0 / 64 + 1.0) / 4.0);
}

// Places on a ring, counted one by one.
TEST(SharedByReplicates, OfARingAgreesWithCounting) {
  for (const int replicates : {2, 3, 5, 8}) {
    for (const int count : {3, 16, 20, 40, 64}) {
      double shared = 0.0, squares = 0.0;
      for (int r = 0; r < replicates; ++r) {
        for (int s = 0; s < r; ++s) {
          std::set<int> first;
          for (int i = 0; i < count; ++i)
            first.insert((static_cast<int>(64 * radical_inverse(static_cast<unsigned>(r))) + i) %
                         64);
          int common = 0;
          for (int i = 0; i < count; ++i)
            common += static_cast<int>(first.count(
                (static_cast<int>(64 * radical_inverse(static_cast<unsigned>(s))) + i) % 64));
          const double share = static_cast<double>(common) / count;
          const double pairs = 0.5 * replicates * (replicates - 1);
          shared += share / pairs;
          squares += share * share / pairs;
        }
      }
      const auto with = [&, c = count, m = replicates](double rare) {
        return shared_by_replicates(taken({{c, 7}}, rare), pairs_of(m), Taking::kOneAround);
      };
      EXPECT_NEAR(with(1.0).samples, shared, 1e-12) << replicates << " of " << count;
      EXPECT_NEAR(with(1.0).correlation, shared, 1e-12) << replicates << " of " << count;
      EXPECT_NEAR(with(0.0).correlation, squares, 1e-12) << replicates << " of " << count;
      EXPECT_NEAR(with(0.3).correlation, 0.3 * shared + 0.7 * squares, 1e-12);
    }
  }
}

TEST(RareShare, GoesFromNormalNoiseToRareEvents) {
  EXPECT_EQ(rare_share(0.0, 8), 0.0);
  EXPECT_EQ(rare_share(-1.2, 8), 0.0);  // lighter tails than normal ones
  EXPECT_DOUBLE_EQ(rare_share(16.0, 8), 0.5);
  EXPECT_EQ(rare_share(std::numeric_limits<double>::infinity(), 8), 1.0);
  EXPECT_EQ(rare_share(std::nan(""), 8), 1.0);
}

// Squared means of n samples, of which m are common: their correlation by simulation, for normal
// samples and for rare ones (1 with probability 1 / 100, excess kurtosis about 94).
TEST(RareShare, MixesTheCorrelationsThatSimulationGives) {
  constexpr int kTrials = 200'000, kTaken = 16, kCommon = 8;
  const double p = 0.01, variance = p * (1 - p);
  const double kurtosis = (1 - 6 * variance) / variance;
  for (const bool rare : {false, true}) {
    double ab = 0.0, aa = 0.0, a_sum = 0.0;
    for (std::uint64_t t = 0; t < kTrials; ++t) {
      double sums[3] = {};
      const int sizes[3] = {kCommon, kTaken - kCommon, kTaken - kCommon};
      for (std::uint64_t part = 0; part < 3; ++part) {
        for (int i = 0; i < sizes[part]; ++i) {
          const double u = unit_double(mix(t, part, static_cast<std::uint64_t>(i), rare));
          const double v = unit_double(mix(t, part, static_cast<std::uint64_t>(i), 2 + rare));
          const double normal =
              std::sqrt(-2 * std::log(1 - u)) * std::cos(2 * std::numbers::pi * v);
          sums[part] += rare ? (u < p ? 1.0 - p : -p) : normal;
        }
      }
      const double a = (sums[0] + sums[1]) * (sums[0] + sums[1]);
      const double b = (sums[0] + sums[2]) * (sums[0] + sums[2]);
      ab += a * b / kTrials;
      aa += 0.5 * (a * a + b * b) / kTrials;
      a_sum += 0.5 * (a + b) / kTrials;
    }
    const double found = (ab - a_sum * a_sum) / (aa - a_sum * a_sum);
    const double share = 0.5, part = rare_share(rare ? kurtosis : 0.0, kTaken);
    // Standard deviation of the estimate, by repeating it: 0.003 and 0.008.
    EXPECT_NEAR(found, part * share + (1 - part) * share * share, rare ? 0.03 : 0.012);
  }
}

TEST(SharedByMethods, MatchesPiecesInTheOrderOfTheirCounts) {
  EXPECT_DOUBLE_EQ(shared_by_methods(taken({{16, 100}}), taken({{16, 100}})), 1.0);
  EXPECT_DOUBLE_EQ(shared_by_methods(taken({{4, 100}}, 0.0), taken({{16, 100}}, 0.0)), 0.25);
  EXPECT_DOUBLE_EQ(shared_by_methods(taken({{4, 100}}, 1.0), taken({{16, 100}}, 0.0)), 0.5);
  // 50 pieces of 4 against 8, 25 of 16 against 8, 25 of 16 against 32.
  EXPECT_DOUBLE_EQ(
      shared_by_methods(taken({{4, 50}, {16, 50}}, 0.0), taken({{8, 75}, {32, 25}}, 0.0)), 0.5);
  EXPECT_DOUBLE_EQ(shared_by_methods(taken({}), taken({{8, 4}})), 1.0);
}

TEST(SharedByDifferences, LosesWhatBothMethodsShare) {
  EXPECT_DOUBLE_EQ(shared_by_differences(0.2, 1.0, 0.9), 0.2);  // one sampler, two filters
  EXPECT_DOUBLE_EQ(shared_by_differences(0.2, 0.8, 0.0), 0.2);
  EXPECT_DOUBLE_EQ(shared_by_differences(0.2, 0.8, -0.5), 0.2);
  EXPECT_DOUBLE_EQ(shared_by_differences(0.2, 0.8, 0.8), 0.0);
  EXPECT_DOUBLE_EQ(shared_by_differences(0.2, 0.8, 0.99), 0.0);
  EXPECT_DOUBLE_EQ(shared_by_differences(0.2, 0.8, 0.4), 0.2 * 0.5 / 0.6);
}

TEST(SharedByReplicates, OfSeveralRecordingsIsDiluted) {
  EXPECT_DOUBLE_EQ(over_recordings(0.3, 4, 1), 0.3);
  EXPECT_DOUBLE_EQ(over_recordings(0.3, 4, 2), 0.3 * 3 / 7);
  EXPECT_EQ(over_recordings(0.3, 1, 1), 0.0);
}

}  // namespace
}  // namespace spool
