// Several recordings of one scene: what varies between them is measured on them.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/inference/comparison.h"
#include "lib/inference/intervals.h"
#include "tests/support/random_images.h"

namespace spool {
namespace {

constexpr int kReplicates = 8;

// Replicates of a recording are nearly the same image: the recording's own deviation is 0.5 of a
// logarithm, a replicate's 0.01.
Series alike(std::uint64_t seed, int recordings) {
  Series series;
  series.recordings = recordings;
  for (int r = 0; r < recordings; ++r) {
    const double of_all = 0.5 * test::normal(seed, 1000u + static_cast<unsigned>(r));
    for (int k = 0; k < kReplicates; ++k) {
      const auto place = static_cast<unsigned>(r * kReplicates + k);
      series.values.push_back(std::exp(of_all + 0.01 * test::normal(seed, place)));
    }
  }
  return series;
}

int covered(int recordings, int told) {
  int count = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    Series series = alike(seed, recordings);
    series.recordings = told;
    const Interval found = mean_interval(series, Range::kPositive);
    count += found.low <= 1.0 && 1.0 <= found.high;
  }
  return count;
}

// 380 of 400 are expected, with a standard deviation of 4.4.
TEST(Recordings, FourOfThemHoldTheMeanOfTheScene) {
  EXPECT_GE(covered(4, 4), 380 - 14);
  EXPECT_LE(covered(4, 4), 380 + 14);
  // Read as one recording of 32 replicates they hold it in few.
  EXPECT_LT(covered(4, 1), 200);
}

TEST(Recordings, FreedomIsThatOfTheRecordings) {
  const Interval found = mean_interval(alike(3, 4), Range::kPositive);
  EXPECT_EQ(found.freedom, 3.0);
  EXPECT_EQ(found.n, 4 * kReplicates);
}

TEST(Recordings, OneWithoutResultsIsLeftOut) {
  Series series = alike(4, 5);
  for (int k = 0; k < kReplicates; ++k)
    series.values[static_cast<std::size_t>(2 * kReplicates + k)] = std::nan("");
  EXPECT_EQ(mean_interval(series, Range::kPositive).freedom, 3.0);
  EXPECT_EQ(mean_interval(series, Range::kPositive).n, 4 * kReplicates);
}

TEST(Recordings, ADifferenceOfTwoMethodsIsOneNumberARecording) {
  const Series a = alike(5, 4);
  Series b = a;
  for (std::size_t r = 0; r < b.values.size(); ++r)
    b.values[r] *= 1.1 * std::exp(0.01 * test::normal(6, static_cast<unsigned>(r)));
  const Comparison found = compare_paired(a, b, Better::kLower);
  EXPECT_EQ(found.freedom, 3.0);
  EXPECT_LT(found.p, 0.01);  // what both share has cancelled
  EXPECT_NEAR(found.difference, -std::log(1.1), 0.01);
  EXPECT_EQ(compare_independent(a, b, Better::kLower).freedom > 3.0, true);
  EXPECT_GT(compare_independent(a, b, Better::kLower).p, 0.5);
}

}  // namespace
}  // namespace spool
