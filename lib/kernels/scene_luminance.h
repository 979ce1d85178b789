// The unit of a picture: what constants that are written for a picture of mean luminance 1 are
// multiples of.
#pragma once

#include "lib/core/guards.h"
#include "lib/statistics/piece_statistics.h"

namespace spool {

// Mean luminance of the pixel means without the largest 1 % of them, radiance units, > 0; 1,
// counted, where that mean is not finite or too small to be a unit (exposure_scale).
double scene_luminance(const PieceStatistics& statistics, GuardCounts& guards);

}  // namespace spool
