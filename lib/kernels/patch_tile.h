// The patch filter (lib/kernels/patch_filter.h) of one tile, with nothing larger than the tile.
#pragma once

#include "lib/kernels/patch_filter.h"

namespace spool {

// The filtered targets [target][y][x] of the tile, from its corner.
std::vector<Plane> filter_tile(const GuidedTargets& guided, const PatchFilterOptions& options,
                               const Rectangle& tile);

}  // namespace spool
