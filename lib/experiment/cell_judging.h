// One cell: its image made of a sampling run by its filter, and judged.
#pragma once

#include <functional>

#include "lib/experiment/cell_sampling.h"

namespace spool {

// Fills `result`, whose cell is known; `shown` gets the images once it is full. Errors: those of
// the filter, and of what it returns.
Result<void> judge_cell(const CellWork& work, const SamplingRun& run, const CellLane& lane,
                        CellResult& result, const std::function<void(const CellImages&)>& shown);

}  // namespace spool
