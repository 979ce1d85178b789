// What the results of a plan say about its methods: DIR/statistics.json, the one place where
// means, intervals, ratios, ranks and verdicts come from. Everything that prints them prints these.
//
//   rules       what an interval and a verdict are about, in words
//   scenes      recordings, those of one scene together
//   claims      those of the plan: its words, the verdict over all places, and each place
//   results     per scene, budget, number of threads and method: every quantity, [mean, low, high]
//   conditions  per scene, budget, threads and metric: methods by mean, with letters, ratio to
//               the baseline, verdicts; for mse and relmse all pairs
//   curves      per scene and method: slope of error over budget; samples that it needs for the
//               error of the baseline, and its error in the baseline's time
//   overall     per budget, threads and method: geometric means over the scenes
#pragma once

#include <nlohmann/json.hpp>

#include "lib/experiment/plan.h"
#include "tools/batch/method_results.h"

namespace spool::tools {

nlohmann::ordered_json statistics_of(const Plan& plan, const ReadRecord& read);

// As it is written. Numbers that are not finite are null.
std::string statistics_text(const nlohmann::ordered_json& statistics);

}  // namespace spool::tools
