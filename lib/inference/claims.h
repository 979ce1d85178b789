// Questions that were written down before a run: is one method's error below a stated multiple of
// another's? They are one family per recording and budget (Holm), apart from the family of all
// pairs, so a plan that asks one question is not charged for those that it does not ask.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lib/inference/comparison.h"

namespace spool {

struct Claim {
  std::string text;          // the question in words
  std::string better, than;  // "SAMPLER + FILTER", by their labels
  std::string metric = "relmse";
  std::vector<double> spp;            // empty: all budgets
  bool fresh = false;                 // errors on samples that had no part in the counts
  double below = 1.0;                 // the ratio that better / than must lie below
  std::string source;                 // free: "LiuZheng, Figure 12"
  int threads = 0, than_threads = 0;  // those of better and of than; 0: alike, at each number

  bool asks(double budget, int at_threads) const;
  friend bool operator==(const Claim&, const Claim&) = default;
};

enum class ClaimVerdict {
  kUnknown,    // not compared
  kUndecided,  // not separated from the stated ratio
  kHolds,
  kReversed,
  kMixed  // over several recordings or budgets: holds on some and is reversed on others
};
std::string_view claim_verdict_name(ClaimVerdict verdict);

struct JudgedClaim {
  Comparison comparison;  // better less than
  double p = 1.0;         // that the ratio is `below`, adjusted for the family; NaN: not known
  ClaimVerdict verdict = ClaimVerdict::kUnknown;
};

// One family: `comparisons[i]` answers a claim with the limit `below[i]`. A limit other than 1
// needs a ratio; where there is none the claim is not known.
std::vector<JudgedClaim> judge_claims(std::span<const Comparison> comparisons,
                                      std::span<const double> below, double significance = 0.05);

// Holds where it holds somewhere and is reversed nowhere; the counts belong beside it.
ClaimVerdict verdict_over(std::span<const ClaimVerdict> places);

}  // namespace spool
