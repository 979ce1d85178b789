#include "lib/statistics/analysis_signal.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "lib/core/pairwise_sum.h"

namespace spool {

double AnalysisSignal::value(const Rgb& radiance) const {
  const double raw = channel == AnalysisChannel::kLuminance
                         ? luminance(radiance[0], radiance[1], radiance[2])
                         : std::max({radiance[0], radiance[1], radiance[2]});
  return exposure * raw;
}

double exposure_scale(const Plane& values, const CountImage& n, GuardCounts& guards) {
  SPOOL_CHECK(values.same_size(n));
  std::vector<std::size_t> order;
  order.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (n[i] > 0) order.push_back(i);
  }
  const std::size_t dropped = order.size() / 100;
  const std::size_t kept = order.size() - dropped;
  if (dropped > 0) {
    std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(kept), order.end(),
                     [&](std::size_t a, std::size_t b) {
                       return values[a] != values[b] ? values[a] < values[b] : a < b;
                     });
    order.resize(kept);
    std::sort(order.begin(), order.end());  // nth_element leaves no defined order for the sum
  }
  const double sum = pairwise_sum(kept, [&](std::size_t i) { return values[order[i]]; });
  const double mean = kept > 0 ? sum / static_cast<double>(kept) : 0.0;
  if (!std::isfinite(mean) || mean < kSmallestExposedMean) {
    guards.add(Guard::kExposureFallback);
    return 1.0;
  }
  return 1.0 / mean;
}

}  // namespace spool
