#include "lib/inference/ranking.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "lib/inference/letter_groups.h"
#include "tests/support/random_images.h"

namespace spool {
namespace {

// Errors around `error` with `noise` of their logarithms, own and shared by all.
Series noisy(double error, double noise, std::uint64_t seed, double shared = 0.0, int n = 8) {
  Series series;
  for (int r = 0; r < n; ++r) {
    const auto word = static_cast<std::uint64_t>(r);
    series.values.push_back(
        error * std::exp(noise * test::normal(seed, word) + shared * test::normal(99, word)));
  }
  return series;
}

TEST(ComparePaired, SeesReplicatesThatAllLieFarApart) {
  const Series a{{0.1, 0.02, 0.5, 0.04}}, b{{0.7, 0.62, 3.6, 0.9}};  // 7, 31, 7.2, 22.5 times
  const Comparison found = compare_paired(a, b, Better::kLower);
  EXPECT_LT(found.p, 0.05);
  EXPECT_EQ(verdict_of(found, found.p), Verdict::kBetter);
  EXPECT_NEAR(found.ratio().mean, 1.0 / std::pow(7.0 * 31 * 7.2 * 22.5, 0.25), 1e-12);
  EXPECT_LT(found.ratio().high, 1.0);
}

TEST(ComparePaired, WhatBothShareCancels) {
  const Comparison alone = compare_paired(noisy(1.0, 0.01, 1), noisy(1.1, 0.01, 2), Better::kLower);
  const Comparison shared =
      compare_paired(noisy(1.0, 0.01, 1, 1.0), noisy(1.1, 0.01, 2, 1.0), Better::kLower);
  EXPECT_NEAR(shared.p, alone.p, 1e-9);
  EXPECT_LT(shared.p, 0.001);
}

TEST(ComparePaired, OfTwoSamplersIsWidenedByWhatTheyDoNotShare) {
  Series a{{1.0, 1.3, 0.9, 1.2}, 0.2}, b{{2.0, 2.2, 1.9, 2.5}, 0.15};
  const auto widening = [](const Comparison& found) {
    double squares = 0.0, mean = 0.0;
    const double logs[] = {std::log(1.0 / 2.0), std::log(1.3 / 2.2), std::log(0.9 / 1.9),
                           std::log(1.2 / 2.5)};
    for (const double value : logs)
      mean += value / 4;
    for (const double value : logs)
      squares += (value - mean) * (value - mean) / 3;
    return found.standard_error * found.standard_error / (squares / 4);
  };
  EXPECT_NEAR(widening(compare_paired(a, b, Better::kLower)), (1 + 3 * 0.2) / 0.8, 1e-12);
  a.taken = {{{16, 10}}, 64, 0.0};
  b.taken = {{{4, 5}, {32, 5}}, 64, 0.0};
  // The logarithms correlate by more than the samples explain, (4/16 + 16/32) / 2: nothing is left.
  EXPECT_NEAR(widening(compare_paired(a, b, Better::kLower)), 1.0, 1e-12);
  b.taken.counts = {{15, 4}, {17, 6}};
  const double same = (4 * 15.0 / 16 + 6 * 16.0 / 17) / 10, measured = 0.7978226101515229;
  const double left = 0.2 * (1 - measured / same) / (1 - measured);
  EXPECT_NEAR(widening(compare_paired(a, b, Better::kLower)), (1 + 3 * left) / (1 - left), 1e-12);
}

TEST(ComparePaired, NoDifferenceAndOneImage) {
  const Series a = noisy(1.0, 0.1, 1);
  const Comparison same = compare_paired(a, a, Better::kLower);
  EXPECT_TRUE(same.identical);
  EXPECT_EQ(same.p, 1.0);
  EXPECT_EQ(verdict_of(same, same.p), Verdict::kIdentical);
  const Series one_image{std::vector<double>(8, 2.0)};
  EXPECT_FALSE(compare_paired(a, one_image, Better::kLower).known());
  EXPECT_FALSE(compare_paired({{1.0}}, {{2.0}}, Better::kLower).known());
}

// Six pairs with a copy of one method, of which one is the copy's: five are compared by chance.
TEST(Ranking, IdenticalMethodsAreNoMembersOfTheFamily) {
  const Series a = noisy(1.0, 0.3, 1), b = noisy(1.2, 0.3, 2), c = noisy(2.0, 0.3, 3);
  const Ranking copied = rank_methods({a, b, c, a}, Better::kLower);
  double largest = 0.0;
  for (const PairVerdict& pair : copied.pairs) {
    if (pair.verdict == Verdict::kIdentical) {
      EXPECT_EQ(pair.p, 1.0);
    } else {
      largest = std::max(largest, pair.factor);
    }
  }
  EXPECT_EQ(largest, 5.0);
  // Where not all pairs are compared, it is none of those that could have been.
  const Ranking few =
      rank_methods({a, b, c, a}, Better::kLower, {.baseline = std::size_t{0}, .most_paired = 3});
  largest = 0.0;
  for (const PairVerdict& pair : few.pairs)
    largest = std::max(largest, pair.factor);
  EXPECT_EQ(largest, 5.0);
}

// Left out, the replicate in which a method failed worst would make it as good as another.
TEST(Ranking, AMethodWithAnInfiniteErrorIsNotCompared) {
  const double infinite = std::numeric_limits<double>::infinity();
  const Series a{{1.0, 1.2, 0.9, 1.1}}, failing{{1.0, infinite, 0.9, 1.1}};
  const Comparison found = compare_paired(failing, a, Better::kLower);
  EXPECT_FALSE(found.identical);
  EXPECT_FALSE(found.known());
  EXPECT_EQ(verdict_of(found, found.p), Verdict::kUnknown);
  EXPECT_FALSE(compare_independent(failing, a, Better::kLower).known());
  const Ranking ranking = rank_methods({failing, a, noisy(2.0, 0.1, 4, 0.0, 4)}, Better::kLower);
  EXPECT_EQ(ranking.methods.front().method, 1u);
  EXPECT_EQ(ranking.methods.back().method, 0u);
  EXPECT_FALSE(ranking.methods.back().compared);
  EXPECT_EQ(ranking.methods.back().mean.mean, infinite);
  EXPECT_TRUE(std::isnan(ranking.methods.back().mean.low));
  EXPECT_TRUE(ranking.pairs.front().comparison.logarithmic);
}

// A cell that failed, or is not there, leaves them the replicates of one image that they are.
TEST(ComparePaired, AMissingReplicateChangesNothingAboutTheOthers) {
  const double none = std::nan("");
  const Series one_image{{2.0, none, 2.0, 2.0}}, a{{1.0, 1.2, none, 1.1}};
  EXPECT_TRUE(one_image.alike());
  EXPECT_FALSE((Series{{2.0, none}}).alike());
  EXPECT_FALSE(compare_paired(one_image, {{1.0, 1.1, 1.2, 1.3}}, Better::kLower).known());
  EXPECT_FALSE(rank_methods({one_image, a}, Better::kLower).methods.back().compared);
  EXPECT_TRUE(compare_paired(a, a, Better::kLower).identical);
  EXPECT_TRUE(compare_paired(a, {{1.0, none, 1.3, 1.1}}, Better::kLower).identical);
  EXPECT_FALSE(compare_paired(a, {{1.0, none, 1.3, 1.2}}, Better::kLower).identical);
  EXPECT_FALSE(compare_independent({{1.0, 1.2}}, {{1.0, 1.2, 1.3}}, Better::kLower).identical);
}

TEST(ComparePaired, WhereAnErrorIsNotPositiveDifferencesAreTakenAsTheyAre) {
  const Series a{{-0.1, 0.1, 0.0, 0.2}}, b{{1.0, 1.1, 1.2, 0.9}};
  const Comparison found = compare_paired(a, b, Better::kLower);
  EXPECT_FALSE(found.logarithmic);
  EXPECT_DOUBLE_EQ(found.difference, -1.0);
  EXPECT_TRUE(std::isnan(found.ratio().mean));
  EXPECT_EQ(verdict_of(found, found.p), Verdict::kBetter);
}

TEST(ComparePaired, ReplicatesWithoutValueAreLeftOut) {
  Series a{{1.0, std::nan(""), 4.0}}, b{{2.0, 5.0, 8.0}};
  const Comparison found = compare_paired(a, b, Better::kLower);
  EXPECT_EQ(found.n, 2);
  EXPECT_NEAR(found.ratio().mean, 0.5, 1e-12);
  EXPECT_EQ(found.p, 0.0);  // no spread
}

// Welch's freedom by hand: variances 1/2 and 8/2 of two logarithms each: 4.5^2 / (0.25 + 16).
TEST(CompareIndependent, HasWelchsFreedom) {
  const Series a{{std::exp(0.0), std::exp(std::sqrt(2.0))}};
  const Series b{{std::exp(9.0), std::exp(13.0)}};
  const Comparison found = compare_independent(a, b, Better::kLower);
  EXPECT_NEAR(found.freedom, 4.5 * 4.5 / 16.25, 1e-9);
  EXPECT_NEAR(found.standard_error, std::sqrt(4.5), 1e-9);
  EXPECT_NEAR(found.difference, std::sqrt(0.5) - 11.0, 1e-9);
}

// Equal methods: 5 % of the comparisons find a difference; 1000 trials, 4 standard deviations.
TEST(ComparePaired, RarelyFindsADifferenceWhereThereIsNone) {
  int found = 0;
  for (std::uint64_t trial = 0; trial < 1000; ++trial) {
    found += compare_paired(noisy(1.0, 0.7, mix(trial, 1), 0.3),
                            noisy(1.0, 0.2, mix(trial, 2), 0.3), Better::kLower)
                 .p < 0.05;
  }
  EXPECT_NEAR(found, 50, 4 * 6.9);
}

TEST(Holm, ByHand) {
  const double p[] = {0.01, 0.04, std::nan(""), 0.03, 0.005};
  // Sorted .005 .01 .03 .04 times 4 3 2 1 = .02 .03 .06 .04 -> never falling.
  const std::vector<double> adjusted = holm_adjusted(p);
  EXPECT_DOUBLE_EQ(adjusted[4], 0.02);
  EXPECT_DOUBLE_EQ(adjusted[0], 0.03);
  EXPECT_DOUBLE_EQ(adjusted[3], 0.06);
  EXPECT_DOUBLE_EQ(adjusted[1], 0.06);
  EXPECT_TRUE(std::isnan(adjusted[2]));
  EXPECT_DOUBLE_EQ(holm_factors(p)[3], 2.0);
  // Of a family of ten: times 10 9 8 7.
  EXPECT_DOUBLE_EQ(holm_adjusted(p, 10)[4], 0.05);
  EXPECT_DOUBLE_EQ(holm_adjusted(p, 10)[1], 0.28);
  const double large[] = {0.5, 0.6};
  EXPECT_DOUBLE_EQ(holm_adjusted(large)[0], 1.0);
  EXPECT_DOUBLE_EQ(holm_factors(large)[0], 2.0);  // which p and 1 do not tell
}

TEST(LetterGroups, ByHand) {
  // 0-1 and 1-2 alike, 0-2 apart, 3 apart from all: a, ab, b, c.
  const auto apart = [](std::size_t i, std::size_t j) { return j == 3 || (i == 0 && j == 2); };
  EXPECT_EQ(letter_groups(4, apart), (std::vector<std::string>{"a", "ab", "b", "c"}));
  EXPECT_EQ(letter_groups(0, apart).size(), 0u);
  EXPECT_EQ(letter_groups(3, [](auto, auto) { return false; }),
            (std::vector<std::string>{"a", "a", "a"}));
}

// Random graphs: two share a letter exactly where they are not apart.
TEST(LetterGroups, ShareALetterExactlyWhereNotApart) {
  for (std::uint64_t trial = 0; trial < 200; ++trial) {
    const std::size_t count = 2 + trial % 12;
    const double density = test::uniform(5, trial);
    const auto apart = [&](std::size_t i, std::size_t j) {
      return test::uniform(mix(6, trial), i, j) < density;
    };
    const std::vector<std::string> letters = letter_groups(count, apart);
    for (std::size_t j = 0; j < count; ++j) {
      EXPECT_FALSE(letters[j].empty());
      for (std::size_t i = 0; i < j; ++i) {
        const bool share = letters[i].find_first_of(letters[j]) != std::string::npos;
        // Letters beyond z are followed by a digit, which twelve items do not reach.
        ASSERT_EQ(letters[i].find_first_of("0123456789"), std::string::npos);
        EXPECT_EQ(share, !apart(i, j)) << trial << ": " << i << ", " << j;
      }
    }
  }
}

// Items of one part are apart: a maximal set has one of each part.
std::vector<std::string> letters_of_parts(const std::vector<std::size_t>& sizes) {
  std::vector<std::size_t> part_of;
  for (std::size_t part = 0; part < sizes.size(); ++part)
    part_of.insert(part_of.end(), sizes[part], part);
  return letter_groups(part_of.size(),
                       [&](std::size_t i, std::size_t j) { return part_of[i] == part_of[j]; });
}

TEST(LetterGroups, OfTooManyGroupsNamesNone) {
  EXPECT_NE(letters_of_parts({2, 2, 2, 2, 2, 5, 5, 5, 5})[0], "");  // 20000 sets
  EXPECT_EQ(letters_of_parts({3, 59, 113})[0], "");                 // 20001
}

TEST(RankMethods, SortsByMeanAndGivesLetters) {
  const std::vector<Series> methods = {noisy(1.5, 0.01, 1), noisy(1.001, 0.02, 22),
                                       noisy(1.0, 0.02, 23), noisy(2.0, 0.01, 4)};
  const Ranking ranking = rank_methods(methods, Better::kLower, {.baseline = 3});
  ASSERT_EQ(ranking.methods.size(), 4u);
  EXPECT_EQ(ranking.methods[2].method, 0u);
  EXPECT_EQ(ranking.methods[3].method, 3u);
  EXPECT_EQ(ranking.methods[0].letters, "a");
  EXPECT_EQ(ranking.methods[1].letters, "a");
  EXPECT_EQ(ranking.methods[2].letters, "b");
  EXPECT_EQ(ranking.methods[3].letters, "c");
  EXPECT_EQ(ranking.pairs.size(), 6u);
  EXPECT_EQ(ranking.between(3, 0), Verdict::kWorse);
  EXPECT_EQ(ranking.between(0, 3), Verdict::kBetter);
  EXPECT_EQ(ranking.between(1, 2), Verdict::kUndecided);
}

TEST(RankMethods, OfManyComparesWithTheBestAndTheBaseline) {
  std::vector<Series> methods;
  for (std::uint64_t m = 0; m < 10; ++m)
    methods.push_back(noisy(1.0 + 0.5 * static_cast<double>(m), 0.01, m));
  const Ranking ranking = rank_methods(methods, Better::kLower, {.baseline = 5, .most_paired = 9});
  EXPECT_EQ(ranking.pairs.size(), 9u + 8u);
  EXPECT_EQ(ranking.methods[3].letters, "");
  EXPECT_EQ(ranking.between(7, 5), Verdict::kWorse);
  EXPECT_EQ(ranking.between(7, 6), Verdict::kUnknown);
}

// Of 40 equal methods the one that looks best was chosen from all: something is claimed in 5 %. 300
// trials, 4 standard deviations; a family of its 39 pairs alone claims something in 20 %.
TEST(RankMethods, TheBestOfManyIsChargedForHavingBeenChosen) {
  int claimed = 0;
  for (std::uint64_t trial = 0; trial < 300; ++trial) {
    std::vector<Series> methods;
    for (std::uint64_t m = 0; m < 40; ++m)
      methods.push_back(noisy(1.0, 0.1, mix(trial, m)));
    const Ranking ranking = rank_methods(methods, Better::kLower, {.most_paired = 20});
    claimed += std::ranges::any_of(
        ranking.pairs, [](const PairVerdict& pair) { return pair.verdict != Verdict::kUndecided; });
  }
  EXPECT_LE(claimed, 15 + 4 * 3.8);
}

// The geometric mean of the first is the lowest of all, its mean is not; one value of the third has
// no logarithm.
TEST(RankMethods, OrderAndVerdictsAreOfOneScale) {
  const std::vector<Series> methods = {Series{{0.01, 4.0, 0.01, 4.0, 0.01, 4.0, 0.01, 4.0}},
                                       noisy(1.0, 0.01, 1), noisy(0.3, 0.01, 2)};
  EXPECT_EQ(rank_methods(methods, Better::kLower).methods[0].method, 0u);
  std::vector<Series> debiased = methods;
  debiased[2].values[3] = -0.1;
  const Ranking ranking = rank_methods(debiased, Better::kLower);
  EXPECT_EQ(ranking.methods[0].method, 2u);
  EXPECT_EQ(ranking.methods[1].method, 1u);
  for (const PairVerdict& pair : ranking.pairs) {
    EXPECT_FALSE(pair.comparison.logarithmic);
    EXPECT_LE(pair.comparison.difference, 0.0);
    EXPECT_NE(pair.verdict, Verdict::kWorse);
  }
  // The ratio is for itself.
  EXPECT_NEAR(ranking.pair(0, 1)->ratio.mean, 1.0 / 0.2, 0.1);
  EXPECT_EQ(ranking.pair(2, 1)->ratio.n, 0);
  // Energies: by how far they are from 1 in each image, which their mean does not say.
  const Ranking energies =
      rank_methods({Series{{0.5, 1.5, 0.6, 1.4}}, noisy(0.9, 0.001, 3, 0.0, 4)}, Better::kOne);
  EXPECT_EQ(energies.methods[0].method, 1u);
}

TEST(RankMethods, WhatIsLeftOutOrOneImageIsListedLastAndNotCompared) {
  const std::vector<Series> methods = {noisy(3.0, 0.01, 1), noisy(1.0, 0.01, 2),
                                       Series{std::vector<double>(8, 0.5)}, noisy(2.0, 0.01, 3),
                                       Series{std::vector<double>(8, std::nan(""))}};
  const Ranking ranking =
      rank_methods(methods, Better::kLower, {.left_out = {false, true, false, false, false}});
  EXPECT_EQ(ranking.methods[0].method, 3u);
  EXPECT_EQ(ranking.methods[1].method, 0u);
  EXPECT_EQ(ranking.pairs.size(), 1u);
  for (std::size_t i = 2; i < 5; ++i)
    EXPECT_FALSE(ranking.methods[i].compared);
  EXPECT_EQ(ranking.methods[4].method, 4u);
}

TEST(RankMethods, OtherDirections) {
  const std::vector<Series> methods = {noisy(30.0, 0.001, 1), noisy(40.0, 0.001, 2)};
  EXPECT_EQ(rank_methods(methods, Better::kHigher).methods[0].method, 1u);
  const std::vector<Series> energies = {noisy(1.3, 0.001, 1), noisy(0.9, 0.001, 2)};
  const Ranking ranking = rank_methods(energies, Better::kOne);
  EXPECT_EQ(ranking.methods[0].method, 1u);
  EXPECT_EQ(ranking.between(1, 0), Verdict::kBetter);
  std::vector<Series> negative = {noisy(0.5, 0.001, 1), noisy(1.3, 0.001, 2)};
  for (double& value : negative[0].values)
    value = -value;
  EXPECT_EQ(rank_methods(negative, Better::kOne).methods[0].method, 1u);
}

}  // namespace
}  // namespace spool
