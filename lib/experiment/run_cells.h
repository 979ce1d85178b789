// Runs cells: recordings are loaded, samples taken, images made and judged.
#pragma once

#include <vector>

#include "lib/experiment/experiment.h"

namespace spool {

// Results in the order of `cells`; shorter (finished cells only) when cancelled.
std::vector<CellResult> run_experiment(const std::vector<Cell>& cells,
                                       const ExperimentOptions& options,
                                       const ExperimentSources& sources,
                                       const ExperimentCallbacks& callbacks = {});
// The same without keeping results: memory does not grow with the number of cells.
void run_cells(const std::vector<Cell>& cells, const ExperimentOptions& options,
               const ExperimentSources& sources, const ExperimentCallbacks& callbacks);

}  // namespace spool
