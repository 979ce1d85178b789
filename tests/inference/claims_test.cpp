// Claims of a plan: one family, a stated limit, verdicts over several recordings.
#include "lib/inference/claims.h"

#include <cmath>

#include <gtest/gtest.h>

namespace spool {
namespace {

// Ratios near `ratio`, known to a standard error of 0.1 with 7 degrees of freedom.
Comparison near_ratio(double ratio) {
  Comparison c;
  c.n = 8;
  c.logarithmic = true;
  c.difference = std::log(ratio);
  c.standard_error = 0.1;
  c.freedom = 7.0;
  c.p = 0.5;  // against 1; a claim tests against its own limit
  return c;
}

ClaimVerdict alone(double ratio, double below) {
  return judge_claims(std::vector{near_ratio(ratio)}, std::vector{below}).front().verdict;
}

TEST(Claims, AreJudgedAgainstTheirOwnLimit) {
  EXPECT_EQ(alone(0.5, 1.0), ClaimVerdict::kHolds);
  EXPECT_EQ(alone(0.5, 0.5), ClaimVerdict::kUndecided);
  EXPECT_EQ(alone(0.5, 0.25), ClaimVerdict::kReversed);
  EXPECT_EQ(alone(1.05, 1.5), ClaimVerdict::kHolds);
  EXPECT_EQ(alone(1.05, 1.0), ClaimVerdict::kUndecided);
}

// Methods with the same values are 1 apart, whatever the limit.
TEST(Claims, OfIdenticalMethodsAreDecidedByTheirLimit) {
  Comparison same;
  same.n = 8;
  same.logarithmic = same.identical = true;
  same.difference = same.standard_error = 0.0;
  same.p = 1.0;
  const auto judged = judge_claims(std::vector{same, same, same}, std::vector{1.0, 2.0, 0.5});
  EXPECT_EQ(judged[0].verdict, ClaimVerdict::kUndecided);
  EXPECT_EQ(judged[1].verdict, ClaimVerdict::kHolds);
  EXPECT_EQ(judged[2].verdict, ClaimVerdict::kReversed);
}

TEST(Claims, AreOneFamily) {
  // p = 0.03 alone, 0.06 and more beside a second claim.
  const Comparison edge = near_ratio(std::exp(-0.27));
  EXPECT_EQ(judge_claims(std::vector{edge}, std::vector{1.0})[0].verdict, ClaimVerdict::kHolds);
  const auto two = judge_claims(std::vector{edge, near_ratio(1.0)}, std::vector{1.0, 1.0});
  EXPECT_EQ(two[0].verdict, ClaimVerdict::kUndecided);
  EXPECT_GT(two[0].p, 0.05);
}

// What is identical is not told apart by chance: asking for it costs the other claims nothing.
TEST(Claims, OfIdenticalMethodsAreNoMember) {
  const Comparison edge = near_ratio(std::exp(-0.27));
  Comparison same = near_ratio(1.0);
  same.identical = true;
  same.p = 1.0;
  const auto judged = judge_claims(std::vector{edge, same, same}, std::vector{1.0, 1.0, 2.0});
  EXPECT_EQ(judged[0].verdict, ClaimVerdict::kHolds);
  EXPECT_DOUBLE_EQ(judged[0].p, judge_claims(std::vector{edge}, std::vector{1.0})[0].p);
  EXPECT_EQ(judged[1].verdict, ClaimVerdict::kUndecided);
  EXPECT_EQ(judged[1].p, 1.0);
  EXPECT_EQ(judged[2].verdict, ClaimVerdict::kHolds);
}

TEST(Claims, WhatIsNotComparedIsNotKnownAndNoMember) {
  const Comparison edge = near_ratio(std::exp(-0.27));
  const auto judged = judge_claims(std::vector{edge, Comparison{}}, std::vector{1.0, 1.0});
  EXPECT_EQ(judged[0].verdict, ClaimVerdict::kHolds);
  EXPECT_EQ(judged[1].verdict, ClaimVerdict::kUnknown);
  Comparison plain = edge;
  plain.logarithmic = false;
  EXPECT_EQ(judge_claims(std::vector{plain}, std::vector{1.1})[0].verdict, ClaimVerdict::kUnknown);
}

TEST(Claims, OverRecordings) {
  using enum ClaimVerdict;
  EXPECT_EQ(verdict_over(std::vector{kHolds, kUndecided, kUnknown}), kHolds);
  EXPECT_EQ(verdict_over(std::vector{kReversed, kUndecided}), kReversed);
  EXPECT_EQ(verdict_over(std::vector{kHolds, kReversed}), kMixed);
  EXPECT_EQ(verdict_over(std::vector{kUndecided, kUnknown}), kUndecided);
  EXPECT_EQ(verdict_over({}), kUnknown);
}

}  // namespace
}  // namespace spool
