// The table that `spool evaluate` prints: means over replicates, and ratios to uniform with box.
#pragma once

#include <string>
#include <vector>

#include "lib/evaluation/experiment.h"

namespace spool::tools {

// One line per recording, budget, sampler and filter. Mean +- standard error over the replicates;
// "x uniform+box" is the ratio of the means at the same recording and budget, where that pair was
// run.
std::string summary_text(const std::vector<CellResult>& results);
std::string summary_json(const std::vector<CellResult>& results);

}  // namespace spool::tools
