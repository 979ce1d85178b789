// What eq 9 looks at: one signal of the pieces.
#pragma once

#include <span>

#include "lib/core/image.h"

namespace spool {

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

}  // namespace spool
