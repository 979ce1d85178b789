// The weight w_k of the squared difference in eq 9, by the rules of SizeFactorRule.
#pragma once

#include <span>

#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/filters/directional/options.h"

namespace spool {

// What eq 9 looks at: one signal of the pieces.
struct FilterSizeInput {
  const Plane& mean;      // q_0 [y][x], exposed
  const Plane& variance;  // v of `mean`
  const CountImage& n;    // samples
  const Plane& minimum;   // exposed extremes of the samples, for the contrast
  const Plane& maximum;
  std::span<const Plane> coarse;       // f_0 .. f_K, for size_coarse = lp
  std::span<const Plane> attenuation;  // A_0 .. A_K, or empty
  int levels = 4;                      // K
};

// w_k of every piece, for the step from R_k to R_{k+1}; the base image's step is weighed as k = 0.
Plane size_factors(const FilterSizeInput& input, int k, const FilterSizeOptions& options,
                   GuardCounts& guards);

// z(gamma) = -ln(1 - (1.9 gamma)^(1 / sqrt 2)), the caution of the greedy selection
// [RousselleKnausZwicker11]; multiplied by 1 - 1/N where N samples are averaged.
double greedy_caution(double gamma);

}  // namespace spool
