// Slow twin of the energy step: both Gaussian sums as double loops over the whole image.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "lib/core/image.h"

namespace spool::reference {

// sum over the pixels inside the image, none beyond 4 sigma, of the normalised Gaussian.
inline Plane gaussian_inside(const Plane& image, double sigma) {
  const int radius = static_cast<int>(4.0 * sigma + 0.5);
  double line = 0.0;
  for (int m = -radius; m <= radius; ++m)
    line += std::exp(-m * m / (2.0 * sigma * sigma));
  Plane out(image.width(), image.height());
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      for (int v = 0; v < out.height(); ++v) {
        for (int u = 0; u < out.width(); ++u) {
          if (std::abs(u - x) > radius || std::abs(v - y) > radius) continue;
          const int d = (u - x) * (u - x) + (v - y) * (v - y);
          out(x, y) += std::exp(-d / (2.0 * sigma * sigma)) / (line * line) * image(u, v);
        }
      }
    }
  }
  return out;
}

inline Plane restore_energy(const Plane& out, const Plane& mean, double sigma, double floor,
                            double top = INFINITY) {
  Plane w(out.width(), out.height()), ratio(out.width(), out.height()), result = out;
  for (std::size_t i = 0; i < out.size(); ++i)
    w[i] = std::pow(std::clamp(out[i], 0.0, top), 2) + floor * floor;
  const Plane around = gaussian_inside(w, sigma);
  for (std::size_t i = 0; i < out.size(); ++i)
    ratio[i] = (mean[i] - out[i]) / around[i];
  const Plane share = gaussian_inside(ratio, sigma);
  for (std::size_t i = 0; i < out.size(); ++i)
    result[i] += w[i] * share[i];
  return result;
}

}  // namespace spool::reference
