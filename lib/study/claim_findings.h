// The claims of a plan, judged from its results.
#pragma once

#include <optional>
#include <vector>

#include "lib/inference/claims.h"
#include "lib/study/method_results.h"
#include "lib/study/place.h"

namespace spool {

// All claims at one place.
struct PlaceClaims {
  StudyPlace place;
  std::vector<std::optional<JudgedClaim>> judged;  // [claim of the plan]; none: it does not ask
  bool biased = false;                             // a method of it
};
// At the plan's budget of this index, for each number of threads: one family.
std::vector<PlaceClaims> claims_at(const Plan& plan, const PlanScene& scene, std::size_t budget,
                                   const SceneMethods& methods);

// One claim: its words, its verdict over all places, and the places.
struct ClaimFinding {
  struct At {
    StudyPlace place;
    JudgedClaim judged;
    bool biased = false;  // judged by what favours one of the two
  };
  Claim claim;
  ClaimVerdict verdict = ClaimVerdict::kUnknown;
  std::vector<At> places;
  bool after_results = false;  // it was added to the plan when there were results
};
std::vector<ClaimFinding> claim_findings(const Plan& plan, const std::vector<PlaceClaims>& places);

}  // namespace spool
