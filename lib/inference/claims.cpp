#include "lib/inference/claims.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lib/core/check.h"

namespace spool {
namespace {

// Two-sided, that the difference is `limit`; NaN where it cannot be said.
double p_of(const Comparison& comparison, double limit) {
  if (!comparison.known()) return comparison.p;
  if (limit != 0.0 && !comparison.logarithmic) return std::numeric_limits<double>::quiet_NaN();
  if (comparison.identical) return limit == 0.0 ? 1.0 : 0.0;
  return comparison.p_of(limit);
}

}  // namespace

bool Claim::asks(double budget, int at_threads) const {
  return (threads == 0 || threads == at_threads) &&
         (spp.empty() || std::ranges::find(spp, budget) != spp.end());
}

std::string_view claim_verdict_name(ClaimVerdict verdict) {
  constexpr std::array<std::string_view, 5> kNames = {"not compared", "undecided", "holds",
                                                      "reversed", "mixed"};
  return kNames[static_cast<std::size_t>(verdict)];
}

std::vector<JudgedClaim> judge_claims(std::span<const Comparison> comparisons,
                                      std::span<const double> below, double significance) {
  SPOOL_CHECK_EQ(comparisons.size(), below.size());
  std::vector<double> p;
  for (std::size_t i = 0; i < comparisons.size(); ++i)
    p.push_back(p_of(comparisons[i], std::log(below[i])));
  const std::vector<double> adjusted = family_of(comparisons, p).p;
  std::vector<JudgedClaim> judged;
  for (std::size_t i = 0; i < comparisons.size(); ++i) {
    JudgedClaim& claim = judged.emplace_back(JudgedClaim{comparisons[i], adjusted[i]});
    if (adjusted[i] != adjusted[i]) continue;
    const bool lower = comparisons[i].difference < std::log(below[i]);
    claim.verdict = !(adjusted[i] < significance) ? ClaimVerdict::kUndecided
                    : lower                       ? ClaimVerdict::kHolds
                                                  : ClaimVerdict::kReversed;
  }
  return judged;
}

ClaimVerdict verdict_over(std::span<const ClaimVerdict> places) {
  const bool holds = std::ranges::find(places, ClaimVerdict::kHolds) != places.end();
  const bool reversed = std::ranges::find(places, ClaimVerdict::kReversed) != places.end();
  if (holds || reversed) {
    if (holds && reversed) return ClaimVerdict::kMixed;
    return holds ? ClaimVerdict::kHolds : ClaimVerdict::kReversed;
  }
  const bool undecided = std::ranges::find(places, ClaimVerdict::kUndecided) != places.end();
  return undecided ? ClaimVerdict::kUndecided : ClaimVerdict::kUnknown;
}

}  // namespace spool
