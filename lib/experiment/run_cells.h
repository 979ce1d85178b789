// Runs cells: recordings are loaded, samples taken, images made and judged.
#pragma once

#include <vector>

#include "lib/experiment/experiment.h"

namespace spool {

// Results are handed over and not kept: memory does not grow with the number of cells.
void run_cells(const std::vector<Cell>& cells, const ExperimentOptions& options,
               const ExperimentSources& sources, const ExperimentCallbacks& callbacks);

}  // namespace spool
