// Greedy error minimisation [RousselleKnausZwicker11]: samples go under the kernels of the pixels
// whose filtered value still has the largest relative error.
//
// Every pixel climbs the ladder of Gaussians (lib/kernels/scale_ladder.h) with sigma = 1, 2, 4, 8
// until bias outweighs variance; the error estimate follows the climb:
//
//   MSE_0 = mean_c Var_0,  MSE_s = MSE_{s-1} + mean_c(loss - gain)
//   e = MSE / (0.1 + I^2) * m / (m + Nsum),  m = samples per pixel of the whole budget
//
// e is taken at the pixel's scale, in exposed units, and not below 0, where only rounding could
// take it: the gains add up to Var_0 - Var_s. m / (m + Nsum) is the part of the error that m more
// samples remove. In an iteration the pixels with the largest e get m samples each, drawn from the
// kernel of their scale: a target outside the image is drawn again, a saturated one up to 16 times,
// then the nearest unsaturated pixel within 3 sigma takes the sample, else it goes to a pot that is
// apportioned over e. Slow twin: tests/reference/greedy_error_reference.h.
#pragma once

#include "lib/sampling/greedy_error_map.h"
#include "lib/sampling/sampler.h"

namespace spool {

Result<SamplingResult> sample_greedy_error(const SamplePool& pool, long long budget,
                                           const GreedyErrorOptions& options,
                                           const SamplingContext& context);

Sampler greedy_error_sampler();

}  // namespace spool
