// The step before R_0 of eq 9: from each piece's mean to the base image (base_image.h).
//
//   T = S_base - S_raw + w_0 (q_base - q_raw)^2
//
// T > 0 keeps the raw mean, after the vote and the evidence of stop_votes.h: a lamp smaller than a
// piece stays one, and its neighbours stay dark. What follows takes the image of that choice for
// its pieces; variances are carried as if neighbours were independent, which the filtered ones are
// not.
#pragma once

#include "lib/core/guards.h"
#include "lib/core/view.h"
#include "lib/filters/directional/options.h"
#include "lib/filters/directional/tile.h"

namespace spool {

// Means and variances of the pieces and of the signals that decide pass the base image's filter.
// Returns 1 for each piece that kept its own, else 0; nothing unless base = chosen.
// Views: T.base, stop.base.
Plane apply_base(const DirectionalOptions& options, Tile& tile, Views* views, GuardCounts& guards);

}  // namespace spool
