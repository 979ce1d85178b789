// The feature-guided filter whose scale minimises an unbiased estimate of the risk, as a
// filter [LiWuChuang12]; lib/kernels/cross_bilateral.h.
#pragma once

#include "lib/filters/filter.h"
#include "lib/kernels/cross_bilateral.h"

namespace spool {

// Errors: those of cross_bilateral().
Result<Reconstruction> reconstruct_cross_bilateral(const Selection& selection,
                                                   const SamplePool& pool,
                                                   const CrossBilateralOptions& options,
                                                   const FilterContext& context);

Filter cross_bilateral_filter();

}  // namespace spool
