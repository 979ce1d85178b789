// Greedy selection: every pixel climbs a ladder of Gaussians until bias outweighs variance
// [RousselleKnausZwicker11].
//
//   I_0 = pixel filter * means,  I_s = G(sigma_s) * I_0,  sigma_s = 2^{-1/2} 2^{(s-1)/2}, s = 1 ..
//   S gain = Var_{s-1} - Var_s,  loss = beta_s (I_s - I_{s-1})^2 beta_1 = 1,  beta_s = (sigma_s^2 +
//   sigma_{s-1}^2) / (sigma_s^2 - sigma_{s-1}^2) stop_s where the channels' mean of z loss - gain
//   >= 0, z = -ln(1 - (1.9 gamma)^{1/sqrt 2}) (1 - 1/N)
//
// N: samples under the peak-normalised kernel of I_0 (s = 1), or their mean under that of I_s. Stop
// maps are blurred with G(alpha sigma_s) * pixel filter, own weight at most 0.01, rounded, and only
// open. Windows are cut and renormalised at the border. Grid `subpixel`, the published one: means
// of 4 x 4 cells per pixel, which are the pixel's where film positions were not recorded, and the
// pixel filter at a quarter of a pixel.
//
// Reconstruction::level is the scale, 0 .. S: the filter's sigma, not 2^level.
// Slow twin: tests/reference/greedy_selection_reference.h.
#pragma once

#include "lib/filters/filter.h"
#include "lib/kernels/scale_ladder.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {

struct GreedySelectionOptions {
  GreedyGrid grid = GreedyGrid::kAuto;
  int scales = 8;  // S
  double gamma = 0.2;
  double alpha = 2.0;  // blur of the stop maps / sigma
  VarianceMode var_mode = VarianceMode::kAuto;
};

// sigma_s, s >= 1, pixels.
double greedy_scale(int s);

Result<Reconstruction> reconstruct_greedy_selection(const Selection& selection,
                                                    const SamplePool& pool,
                                                    const GreedySelectionOptions& options,
                                                    const FilterContext& context);

Filter greedy_selection_filter();

}  // namespace spool
