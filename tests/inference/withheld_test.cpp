// Errors that have neither interval nor verdict, and why.
#include "lib/inference/withheld.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lib/inference/comparison.h"
#include "lib/inference/ranking.h"

namespace spool {
namespace {

TEST(Withheld, FewPixelsCountUntilThreeRecordingsShowWhatVaries) {
  EXPECT_EQ(withheld_of({.half_pixels = kFewPixels - 1.0}), Withheld::kFewPixels);
  EXPECT_EQ(withheld_of({.half_pixels = kFewPixels}), Withheld::kNo);
  EXPECT_EQ(withheld_of({.half_pixels = kFewestPixels, .halves = true}), Withheld::kNo);
  EXPECT_EQ(withheld_of({.half_pixels = kFewestPixels - 1.0, .halves = true}),
            Withheld::kFewPixels);
  EXPECT_EQ(withheld_of({.half_pixels = 1.0, .own_spread = true}), Withheld::kNo);
  // Eight replicates that share nothing have the error in pixels of their own.
  EXPECT_EQ(withheld_of({.half_pixels = 5.0, .independent_replicates = 8.0}), Withheld::kNo);
  EXPECT_EQ(withheld_of({}), Withheld::kNo);  // results of an older program
}

TEST(Withheld, ANoisyReferenceCountsHoweverManyRecordingsThereAre) {
  const ErrorStanding noisy{.half_pixels = 1e3, .reference_noise = 2.0 * kMostReferenceNoise};
  EXPECT_EQ(withheld_of(noisy), Withheld::kReferenceNoise);
  ErrorStanding group = noisy;
  group.own_spread = true;
  EXPECT_EQ(withheld_of(group), Withheld::kReferenceNoise);
  EXPECT_EQ(withheld_of({.reference_noise = kMostReferenceNoise}), Withheld::kNo);
}

TEST(Withheld, HasAMeanAndNoIntervalAndIsNotCompared) {
  Series a{{1.0, 1.1, 0.9, 1.0}}, b{{2.0, 2.2, 1.9, 2.1}};
  ASSERT_TRUE(compare_paired(a, b, Better::kLower).known());
  a.withheld = Withheld::kFewPixels;
  const Interval mean = mean_interval(a, Range::kPositive);
  EXPECT_NEAR(mean.mean, std::pow(0.99, 0.25), 1e-12);
  EXPECT_TRUE(std::isnan(mean.low) && std::isnan(mean.high));
  for (const Comparison& c :
       {compare_paired(a, b, Better::kLower), compare_paired(b, a, Better::kLower),
        compare_independent(a, b, Better::kLower)}) {
    EXPECT_FALSE(c.known());
    EXPECT_EQ(c.withheld, Withheld::kFewPixels);
    EXPECT_TRUE(std::isfinite(c.difference));
    EXPECT_EQ(verdict_of(c, c.p), Verdict::kUnknown);
  }
  const Ranking ranking = rank_methods({a, b, b}, Better::kLower);
  EXPECT_FALSE(ranking.methods.back().compared);
  EXPECT_EQ(ranking.methods.back().method, 0u);
  EXPECT_EQ(ranking.pair(0, 1), nullptr);
}

}  // namespace
}  // namespace spool
