// The claims of a plan, judged from its results, as JSON.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "lib/experiment/plan_cells.h"
#include "lib/inference/claims.h"
#include "tools/batch/method_results.h"

namespace spool::tools {

// What one scene, budget and number of threads says of every claim that asks about it.
struct ClaimPlace {
  PlanScene scene;
  double spp = 0;
  int threads = 0;
  // [claim of the plan]; not compared where the claim does not ask.
  std::vector<JudgedClaim> judged;
  std::vector<bool> asked;
};

ClaimPlace judge_claims(const Plan& plan, const PlanScene& scene, double spp, int threads,
                        const std::vector<MethodResults>& methods);

// One entry for each claim of the plan: its words, its verdict over all places, and the places.
nlohmann::ordered_json claims_json(const Plan& plan, const std::vector<ClaimPlace>& places);

// The claims as lines for the terminal; empty without claims.
std::string claims_text(const nlohmann::ordered_json& statistics);

}  // namespace spool::tools
