// A study as JSON: DIR/statistics.json, DIR/claims.json, and what `spool evaluate --json` prints.
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
//
// Numbers that are not finite are null.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "lib/study/ranked_results.h"
#include "lib/study/study.h"

namespace spool::tools {

void write_statistics(std::ostream& out, const Study& study);

// What --json prints: the baseline, the claims, what verdicts on mse and relmse are about, and the
// results; all as in statistics.json, each result with its ranks.
std::string study_text(const Study& study);

// The claims of a statistics.json that another program may have changed: what is not text is left
// empty.
struct KeptClaim {
  std::string text, verdict;
};
std::vector<KeptClaim> kept_claims(const std::filesystem::path& statistics_file);

// FOLDER/claims.json, which claims of a plan were there before its first result: keeps the plan's
// claims, of a folder without a finished result; marks what the file does not hold.
Result<void> register_claims(const std::filesystem::path& folder, const Plan& plan);
void mark_late_claims(const std::filesystem::path& folder, std::vector<ClaimFinding>& claims);

}  // namespace spool::tools
