// How far a sample is felt.
#pragma once

#include "lib/core/rectangle.h"
#include "lib/sampling/multiscale/options.h"

namespace spool {

// Pieces whose statistics can change an analysis of `area`: area, grown by the reach of the
// filters, its corner on the lattice of the coarsest level.
Rectangle analysis_window(const Rectangle& area, const Rectangle& bounds,
                          const MultiscaleOptions& options);

}  // namespace spool
