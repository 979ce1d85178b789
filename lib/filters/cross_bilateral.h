// The feature-guided filter whose scale minimises an unbiased estimate of the risk, as a
// filter [LiWuChuang12]; lib/kernels/cross_bilateral.h.
#pragma once

#include "lib/filters/filter.h"
#include "lib/kernels/cross_bilateral.h"

namespace spool {

// robust; paper: s = 0, 1, 2, 4, 8, the risk smoothed with 8; cross_nl_means: patches of the image
// beside the features, the authors' program's own default.
const Presets<CrossBilateralOptions>& cross_bilateral_presets();

// Errors: those of cross_bilateral().
Result<Reconstruction> reconstruct_cross_bilateral(const Selection& selection,
                                                   const SamplePool& pool,
                                                   const CrossBilateralOptions& options,
                                                   const FilterContext& context);

Filter cross_bilateral_filter();

}  // namespace spool
