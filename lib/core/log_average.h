// The log-average luminance, exp(mean of ln(Y + floor)), which brings a picture to middle grey.
#pragma once

#include <algorithm>
#include <cmath>

namespace spool {

// What black counts for: 1e-4 where the mean luminance is 0.01 to 100, beyond that a share of it.
// Radiance in another unit, as small as 1e-6 or as large as 1e6, is the same picture.
inline double log_average_floor(double mean_luminance) {
  if (!(mean_luminance > 0.0) || !std::isfinite(mean_luminance)) return 1e-4;
  return std::clamp(1e-4, 1e-6 * mean_luminance, 1e-2 * mean_luminance);
}

}  // namespace spool
