#include "lib/filters/directional/filter_offsets.h"

#include <cmath>
#include <numbers>

#include "lib/core/check.h"

namespace spool {

Sector sector_of(double b, std::span<const double> beta) {
  const int count = static_cast<int>(beta.size());
  SPOOL_CHECK_GT(count, 0);
  b = std::fmod(b, 180.0);
  if (b < 0.0) b += 180.0;
  if (b >= 180.0) b = 0.0;  // -1e-20 + 180
  int lower = count - 1;
  for (int i = 0; i < count && beta[static_cast<std::size_t>(i)] <= b; ++i)
    lower = i;
  const bool before_first = b < beta[0];
  if (before_first) lower = count - 1;
  const double from = beta[static_cast<std::size_t>(lower)] - (before_first ? 180.0 : 0.0);
  const int upper = (lower + 1) % count;
  const bool wraps = lower == count - 1 && !before_first;
  const double to = beta[static_cast<std::size_t>(upper)] + (wraps ? 180.0 : 0.0);
  return {lower, upper, count == 1 ? 0.0 : (b - from) / (to - from)};
}

double lower_weight(const Sector& sector, Eq12 form) {
  return form == Eq12::kCorrected ? 1.0 - sector.t : sector.t;
}

double interpolated_width(const Sector& sector, std::span<const double> delta, Eq12 form) {
  const double weight = lower_weight(sector, form);
  return weight * delta[static_cast<std::size_t>(sector.lower)] +
         (1.0 - weight) * delta[static_cast<std::size_t>(sector.upper)];
}

int filter_radius(int level) {
  return 1 << (level - 1);
}

std::vector<FilterOffset> filter_offsets(int level, std::span<const double> beta,
                                         FilterWindow window) {
  SPOOL_CHECK_GE(level, 1);
  const int radius = filter_radius(level);
  std::vector<FilterOffset> offsets;
  for (int dy = 0; dy <= radius; ++dy) {
    for (int dx = -radius; dx <= radius; ++dx) {
      if (dy == 0 && dx <= 0) continue;
      const double squared = static_cast<double>(dx) * dx + static_cast<double>(dy) * dy;
      if (window == FilterWindow::kDisc && squared > static_cast<double>(radius) * radius) continue;
      const double b = std::atan2(dy, dx) * (180.0 / std::numbers::pi);
      offsets.push_back({dx, dy, squared, sector_of(b, beta)});
    }
  }
  return offsets;
}

}  // namespace spool
