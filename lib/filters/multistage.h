// Multistage: box filters of growing width, so that a cluster of dense samples does not outweigh
// its sparse neighbours. After the description of [Mitchell87] (abstract only; the widths are
// ours).
//
// Cells of a quarter pixel. Stage 0: mean of a cell's samples. Stage 1: mean of the defined cells
// in the 2 x 2 window at offsets -1, 0. Stage 2: of stage 1 in the 4 x 4 window at offsets -1 .. 2.
// Stage 3: the pixel is the mean of stage 2 in its own 4 x 4 cells. What has no defined input stays
// undefined; an undefined pixel takes the nearest defined one. Support 2.5 pixels, centred.
// Without film positions the result is the box filter's, and a note says so.
// Slow twin: tests/reference/multistage_reference.h.
#pragma once

#include "lib/filters/filter.h"

namespace spool {

struct MultistageOptions {};

Result<Reconstruction> reconstruct_multistage(const Selection& selection, const SamplePool& pool,
                                              const MultistageOptions& options,
                                              const FilterContext& context);

Filter multistage_filter();

}  // namespace spool
