#include "lib/statistics/analysis_signal.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/core/pairwise_sum.h"
#include "lib/core/total_order.h"

namespace spool {

double AnalysisSignal::value(const Rgb& radiance) const {
  const double raw = channel == AnalysisChannel::kLuminance
                         ? luminance(radiance[0], radiance[1], radiance[2])
                         : std::max({radiance[0], radiance[1], radiance[2]});
  return exposure * raw;
}

double exposure_scale(const Plane& values, const CountImage& n, GuardCounts& guards) {
  SPOOL_CHECK(values.same_size(n));
  std::vector<double> sampled;  // in the order of the pieces, which the sum goes by
  sampled.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (n[i] > 0) sampled.push_back(values[i]);
  }
  const std::size_t dropped = sampled.size() / 100;
  const std::size_t kept = sampled.size() - dropped;
  if (dropped > 0) {
    std::vector<double> ranked = sampled;
    const auto cut = ranked.begin() + static_cast<std::ptrdiff_t>(kept);
    std::nth_element(ranked.begin(), cut, ranked.end(), ascending);
    // Of equal values the first of the image are kept.
    const double largest = *cut;
    auto equal = kept - static_cast<std::size_t>(std::count_if(
                            ranked.begin(), cut, [&](double value) { return value < largest; }));
    std::size_t end = 0;
    for (const double value : sampled) {
      if (value > largest || (value == largest && equal == 0)) continue;
      if (value == largest) --equal;
      sampled[end++] = value;
    }
    sampled.resize(end);
  }
  const double sum = pairwise_sum(kept, [&](std::size_t i) { return sampled[i]; });
  const double mean = kept > 0 ? sum / static_cast<double>(kept) : 0.0;
  if (!std::isfinite(mean) || mean < kSmallestExposedMean) {
    guards.add(Guard::kExposureFallback);
    return 1.0;
  }
  return 1.0 / mean;
}

}  // namespace spool
