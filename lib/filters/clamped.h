// Control: the box filter with a clamp on uniform samples, and nothing else. A method that beats it
// only removes fireflies.
//
//   T_p   = factor * mean of the mean luminances of the (up to 8) other pixels of the 3x3 window
//   image = mean of the pixel's samples, the one of largest luminance scaled down to T_p where it
//           exceeds it
//
// One sample of a pixel at most is changed, so a light in two samples of a pixel is dimmed
// but not lost. Errors fall by much and energy is lost: the measure of how much of a gain is the
// removal of bright samples. A picture of one pixel has no neighbours and is the box filter's. Slow
// twin: tests/reference/clamped_reference.h.
#pragma once

#include "lib/filters/filter.h"

namespace spool {

struct ClampedOptions {
  double factor = 4.0;
};

Result<Reconstruction> reconstruct_clamped(const Selection& selection, const SamplePool& pool,
                                           const ClampedOptions& options, const FilterContext&);

Filter clamped_filter();

}  // namespace spool
