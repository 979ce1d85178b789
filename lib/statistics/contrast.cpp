#include "lib/statistics/contrast.h"

#include <cmath>

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

}  // namespace spool
