// The feature-guided filter whose scale minimises an unbiased estimate of the risk, as a
// reconstructor [LiWuChuang12]; lib/kernels/cross_bilateral.h.
#pragma once

#include "lib/filters/reconstructor_entry.h"
#include "lib/kernels/cross_bilateral.h"

namespace spool {

// Errors: those of cross_bilateral().
Result<Reconstruction> reconstruct_cross_bilateral(const Selection& selection,
                                                   const SamplePool& pool,
                                                   const ReconstructionContext& context,
                                                   const CrossBilateralOptions& options);

ReconstructorMethod<CrossBilateralOptions> cross_bilateral_method();

}  // namespace spool
