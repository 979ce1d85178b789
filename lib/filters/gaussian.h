// Gaussian: the pixel means blurred with one Gaussian, the simplest filter and the bar for others.
//
//   image = G_sigma * pixel means,  variance = (G_sigma)^2 * variance of the pixel means
//
// Taps are cut at radius ceil(3 sigma), sum to 1, and extend symmetrically beyond the border. The
// variance takes the pixels as independent; taps that the border folds onto one pixel are added
// before they are squared.
// Slow twin: tests/reference/gaussian_reference.h.
#pragma once

#include "lib/filters/filter.h"

namespace spool {

struct GaussianOptions {
  double sigma = 1.0;  // pixels
};

Result<Reconstruction> reconstruct_gaussian(const Selection& selection, const SamplePool& pool,
                                            const GaussianOptions& options,
                                            const FilterContext& context);

Filter gaussian_filter();

}  // namespace spool
