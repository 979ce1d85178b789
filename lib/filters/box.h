// Box: the pixel is the mean of its samples, the estimate that needs no filter.
//
// The variance is that of the mean (variance_of_mean.h); with q = 2 the pixel is the equal-weight
// mean of its pieces.
#pragma once

#include "lib/filters/filter.h"

namespace spool {

struct BoxOptions {};

Result<Reconstruction> reconstruct_box(const Selection& selection, const SamplePool& pool,
                                       const BoxOptions& options, const FilterContext& context);

Filter box_filter();

}  // namespace spool
