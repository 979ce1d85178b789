// The errors of one estimate: each metric's value and standard error, and what they stand on.
#pragma once

#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

#include "lib/core/guards.h"
#include "lib/core/image.h"

namespace spool {

struct MetricValue {
  double value = std::numeric_limits<double>::quiet_NaN();           // NaN: not defined here
  double standard_error = std::numeric_limits<double>::quiet_NaN();  // NaN: not known
};

// What an error stands on. NaN: not known.
struct ErrorSupport {
  double worst_share = std::numeric_limits<double>::quiet_NaN();  // of the worst 0.1 % of pixels
  double half_pixels = std::numeric_limits<double>::quiet_NaN();  // how many bear half of it
  // Mean of the reference's variance, in units of the metric.
  double reference_noise = std::numeric_limits<double>::quiet_NaN();
};

struct MetricTable {
  std::vector<MetricValue> values;             // [metric], as metrics()
  std::vector<std::vector<double>> resampled;  // [metric][resample], for paired differences
  int blocks = 0;                              // that each resample draws
  double relative_scale = 1.0;                 // factor on both images in the relative metrics
  std::uint64_t pixels = 0;                    // judged
  std::uint64_t excluded_estimate = 0;         // pixels of I that are not finite
  std::uint64_t excluded_reference = 0;        // pixels without a finite R
  bool failed = false;                         // I held a non-finite pixel
  ErrorSupport squared, relative;              // of mse (before its debiasing) and of relmse
  GuardCounts guards;
  Plane flip;  // flip_ldr of each pixel, 0 where not judged; empty where it was not wanted

  const MetricValue& operator[](std::string_view name) const;  // the metric must exist
};

}  // namespace spool
