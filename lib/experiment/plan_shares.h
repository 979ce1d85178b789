// The sampling runs of a plan, and which machine does which.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lib/experiment/cell.h"

namespace spool {

// Cells that share their samples: one recording, sampler, budget, replicate, number of threads.
struct PlannedRun {
  std::string dump;
  std::vector<std::size_t> cells;  // places in the list that it was made of
  double cost = 0.0;               // any unit, positive
};

// In the order of their first cells; without costs.
std::vector<PlannedRun> sampling_runs(const std::vector<Cell>& cells);

// The share, 0 .. `shares` - 1, of each run: longest first to the share with the least to do
// [Graham69], runs of one recording on as few shares as keep the largest within kMostUneven of the
// best that is possible. Depends on nothing but its arguments: the same on every machine.
inline constexpr double kMostUneven = 1.1;
std::vector<int> balanced_shares(const std::vector<PlannedRun>& runs, int shares);

}  // namespace spool
