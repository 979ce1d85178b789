#include "lib/statistics/contrast.h"

#include <cmath>
#include <vector>

#include "lib/core/parallel.h"

namespace spool {

double squared_contrast(double minimum, double maximum, ContrastForm form, GuardCounts& guards) {
  if (form == ContrastForm::kGuarded) {
    const double c =
        (maximum - minimum) / (std::abs(maximum) + std::abs(minimum) + kContrastEpsilon);
    return c * c;
  }
  const double sum = maximum + minimum;
  if (std::abs(sum) < 1e-30) {
    guards.add(Guard::kContrastUndefined);
    return 0.0;
  }
  const double c = (maximum - minimum) / sum;
  return c * c;
}

Plane squared_contrast(const PieceStatistics& statistics, ContrastForm form, GuardCounts& guards) {
  Plane contrast(statistics.width(), statistics.height());
  std::vector<GuardCounts> rows(static_cast<std::size_t>(contrast.height()));
  parallel_rows(0, contrast.height(), [&](int y) {
    for (int x = 0; x < contrast.width(); ++x) {
      if (statistics.n(x, y) < 2) continue;
      contrast(x, y) =
          squared_contrast(statistics.analysis.minimum(x, y), statistics.analysis.maximum(x, y),
                           form, rows[static_cast<std::size_t>(y)]);
    }
  });
  for (const GuardCounts& row : rows)
    guards += row;
  return contrast;
}

}  // namespace spool
