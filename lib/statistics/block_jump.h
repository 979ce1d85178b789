// Whether a density of samples shows blocks.
#pragma once

#include "lib/core/image.h"

namespace spool {

// Mean |difference| of neighbouring counts across every multiple of `step` columns and rows, over
// that of all other neighbours: 1 where nothing is special about these borders. NaN where there is
// no border or all other neighbours are equal.
double block_jump(const Image<int>& counts, int step);

}  // namespace spool
