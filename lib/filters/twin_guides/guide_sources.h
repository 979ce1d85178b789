// What the guides are made of.
#pragma once

#include <array>

#include "lib/filters/twin_guides/sample_moments.h"

namespace spool {

// [P, t][channel]: the pilot and the mean of the logarithms (guides.h), with variances, unblurred
// or on one level.
struct GuideSources {
  std::array<FloatRgb, 2> mean, variance;
};

}  // namespace spool
