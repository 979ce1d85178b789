#include "lib/filters/directional/base_image.h"

#include <cmath>

namespace spool {

Taps base_taps(BaseImage base) {
  if (base == BaseImage::kNone) return {0, {1.0}};
  const double side = std::exp(-2.0) - std::exp(-8.0), middle = 1.0 - std::exp(-8.0);
  const double sum = middle + 2.0 * side;
  return {-1, {side / sum, middle / sum, side / sum}};
}

Taps squared_base_taps(BaseImage base) {
  Taps taps = base_taps(base);
  for (double& tap : taps.values)
    tap *= tap;
  return taps;
}

}  // namespace spool
