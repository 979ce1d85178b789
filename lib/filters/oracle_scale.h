// Oracle scale: of a ladder of Gaussians each pixel takes the one nearest to the reference.
//
// Not a method: it knows the answer. It bounds what any choice of a round filter's size can reach.
// The squared error that decides is averaged over channels and blurred with a Gaussian of
// `error_smoothing` pixels; 0 lets every pixel pick its luckiest scale.
// Scale 0 is the pixel mean, scale s has sigma 2^{(s-2)/2}; Reconstruction::level is the scale.
// Slow twin: tests/reference/oracle_scale_reference.h.
#pragma once

#include "lib/filters/filter.h"

namespace spool {

struct OracleScaleOptions {
  int scales = 10;
  double error_smoothing = 1.0;  // pixels
};

// Error kData without a reference of the image's size.
Result<Reconstruction> reconstruct_oracle_scale(const Selection& selection, const SamplePool& pool,
                                                const OracleScaleOptions& options,
                                                const FilterContext& context);

Filter oracle_scale_filter();

}  // namespace spool
