// The scalar that a method looks at when it decides: a channel of the radiance, scaled by a frozen
// exposure. Estimates never use it.
//
// Eq 5 adds a contrast without unit to a squared radiance, so every decision is made on
// exposure * Y with the mean luminance near 1; absolute guards are written for that scale.
#pragma once

#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/core/option_table.h"
#include "lib/pool/sanitise.h"

namespace spool {

enum class AnalysisChannel { kLuminance, kMaxRgb };

struct AnalysisSignal {
  AnalysisChannel channel = AnalysisChannel::kLuminance;
  double exposure = 1.0;

  double value(const Rgb& radiance) const;
  friend bool operator==(const AnalysisSignal&, const AnalysisSignal&) = default;
};

// The smallest normal float: a recording with a smaller mean has lost the digits of its samples.
inline constexpr double kSmallestExposedMean = 0x1p-126;

// 1 / (mean of the values after the largest 1 % are dropped: by value, ties by index); 1,
// counted, when that mean is not finite or below kSmallestExposedMean. `values` are unexposed; only
// those with n > 0 count.
double exposure_scale(const Plane& values, const CountImage& n, GuardCounts& guards);

}  // namespace spool
