// The scalar that a method looks at when it decides: a channel of the radiance, scaled by a frozen
// exposure, optionally limited and mapped. Estimates never use it.
//
// Eq 5 adds a contrast without unit to a squared radiance, so every decision is made on
// exposure * Y with the mean luminance near `key`; absolute guards are written for that scale.
#pragma once

#include <limits>

#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/core/option_table.h"
#include "lib/pool/sanitise.h"

namespace spool {

enum class AnalysisChannel { kLuminance, kMaxRgb };
enum class DecisionMap { kLinear, kLog1p };

struct AnalysisSignal {
  AnalysisChannel channel = AnalysisChannel::kLuminance;
  double exposure = 1.0;
  double clamp = std::numeric_limits<double>::infinity();  // of the exposed value
  DecisionMap map = DecisionMap::kLinear;                  // kLog1p: sign(v) log(1 + |v|)

  double value(const Rgb& radiance) const;
  bool is_linear() const {
    return map == DecisionMap::kLinear && clamp == std::numeric_limits<double>::infinity();
  }
  friend bool operator==(const AnalysisSignal&, const AnalysisSignal&) = default;
};

// The smallest normal float: a recording with a smaller mean has lost the digits of its samples.
inline constexpr double kSmallestExposedMean = 0x1p-126;

// key / (mean of the values after the largest 1 % are dropped: by value, ties by index); 1,
// counted, when that mean is not finite or below kSmallestExposedMean. `values` are unexposed; only
// those with n > 0 count.
double exposure_scale(const Plane& values, const CountImage& n, double key, GuardCounts& guards);

}  // namespace spool
