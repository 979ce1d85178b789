#include "lib/experiment/stage_clock.h"

#include <algorithm>

namespace spool {

StageTime median_time(std::vector<StageTime> times) {
  const auto middle = [&](auto member) {
    std::ranges::sort(times, {}, member);
    const std::size_t n = times.size();
    return 0.5 * (times[(n - 1) / 2].*member + times[n / 2].*member);
  };
  const double cpu = middle(&StageTime::cpu);
  const double wall = middle(&StageTime::wall);  // leaves them sorted by wall time
  return {wall, cpu, times.back().wall - times.front().wall};
}

StageTime mean_time(const std::vector<StageTime>& times) {
  StageTime mean;
  for (const StageTime& time : times) {
    mean.wall += time.wall / static_cast<double>(times.size());
    mean.cpu += time.cpu / static_cast<double>(times.size());
    mean.spread += time.spread / static_cast<double>(times.size());
  }
  return mean;
}

}  // namespace spool
