#include "lib/inference/equal_time.h"

#include <algorithm>
#include <cmath>

#include "lib/inference/log_combination.h"

namespace spool {

EqualTime equal_time(std::span<const TimedError> curve, const TimedError& target) {
  EqualTime found;
  std::vector<TimedError> points;
  for (const TimedError& point : curve) {
    if (point.seconds > 0.0 && std::isfinite(point.seconds)) points.push_back(point);
  }
  if (points.empty() || !(target.seconds > 0.0) || !std::isfinite(target.seconds)) return found;
  std::ranges::stable_sort(points, {}, &TimedError::seconds);
  found.too_slow = target.seconds < points.front().seconds;
  found.too_fast = target.seconds > points.back().seconds;
  if (found.too_slow || found.too_fast) return found;
  const auto after = std::ranges::find_if(
      points, [&](const TimedError& point) { return point.seconds >= target.seconds; });
  std::vector<WeightedSeries> parts = {{-1.0, target.error}};
  if (after == points.begin()) {
    parts.push_back({1.0, after->error});
  } else {
    const TimedError& before = *std::prev(after);
    const double share =
        std::log(target.seconds / before.seconds) / std::log(after->seconds / before.seconds);
    parts.push_back({1.0 - share, before.error});
    parts.push_back({share, after->error});
  }
  found.ratio = ratio_of_logs(log_combination(parts));
  return found;
}

}  // namespace spool
