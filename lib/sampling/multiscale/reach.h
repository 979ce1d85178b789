// How far a sample is felt.
#pragma once

#include <vector>

#include "lib/core/rectangle.h"
#include "lib/sampling/multiscale/options.h"

namespace spool {

// How far from a changed piece the images of each level change, in x and y alike.
struct StepReach {
  std::vector<int> coarse;  // of f_0, f_1, ...
  std::vector<int> detail;  // of d_0, d_1, ...
};

StepReach step_reach(const MultiscaleOptions& options);

// Pieces whose statistics can change an analysis of `area`: area, grown by the reach of the
// filters, its corner on the lattice of the coarsest level.
Rectangle analysis_window(const Rectangle& area, const Rectangle& bounds,
                          const MultiscaleOptions& options);

}  // namespace spool
