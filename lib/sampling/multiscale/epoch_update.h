// update=epoch: a step takes many regions that do not overlap; then the analysis is brought up to
// date where the step matters, block by block: bit for bit the analysis of everything.
#pragma once

#include <memory>

#include "lib/sampling/multiscale/update.h"

namespace spool {

// A step takes the `epochs`-th part of the budget, or a little more: whole regions.
std::unique_ptr<Update> epoch_update(EpochBoard& board, long long budget,
                                     const MultiscaleOptions& options);

}  // namespace spool
