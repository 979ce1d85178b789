// Slow twin of lib/filters/directional/structure_tensor.h: the derivative along each
// direction by itself, squared and blurred, instead of one tensor for all.
#pragma once

#include <cmath>

#include "lib/core/extend.h"
#include "lib/core/image.h"

namespace spool::reference {

// Energy of structure along `angle` (degrees): G_s * (derivative across it)^2.
inline Plane structure_energy(const Plane& f, double angle, double sigma) {
  const int width = f.width(), height = f.height();
  const double across = (angle + 90.0) * M_PI / 180.0;
  const auto at = [&](int x, int y) {
    return f(extend_symmetric(x, width), extend_symmetric(y, height));
  };
  const auto squared_derivative = [&](int x, int y) {
    const double d = std::cos(across) * (at(x + 1, y) - at(x - 1, y)) / 2.0 +
                     std::sin(across) * (at(x, y + 1) - at(x, y - 1)) / 2.0;
    return d * d;
  };
  Plane energy(width, height);
  const int radius = static_cast<int>(std::ceil(3.0 * sigma));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0.0, weights = 0.0;
      for (int dy = -radius; dy <= radius; ++dy) {
        for (int dx = -radius; dx <= radius; ++dx) {
          const double w = std::exp(-(dx * dx + dy * dy) / (2 * sigma * sigma));
          sum += w * squared_derivative(extend_symmetric(x + dx, width),
                                        extend_symmetric(y + dy, height));
          weights += w;
        }
      }
      energy(x, y) = sum / weights;
    }
  }
  return energy;
}

}  // namespace spool::reference
