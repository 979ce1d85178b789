// Slow twin of lib/kernels/cross_patches.h: one pixel, one pair and one patch at a time; what the
// risk needs of the derivative is a difference quotient.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include "lib/kernels/cross_patches.h"

namespace spool::reference {

// F of channel c at (px, py), the patches' distances taken in y.
inline double cross_patch_mean(const RgbImage& y, const Plane& target,
                               const std::function<double(int, int, int, int)>& feature_weight,
                               double sigma, const CrossPatchOptions& options, int px, int py) {
  const int width = target.width(), height = target.height(), f = options.patch, r = options.window;
  const auto inside = [&](int x, int row) {
    return x >= 0 && row >= 0 && x < width && row < height;
  };
  double sum = 0.0, total = 0.0;
  for (int qy = std::max(0, py - r); qy <= std::min(height - 1, py + r); ++qy) {
    for (int qx = std::max(0, px - r); qx <= std::min(width - 1, px + r); ++qx) {
      double distance = 0.0;
      for (int by = -f; by <= f; ++by) {
        for (int bx = -f; bx <= f; ++bx) {
          if (!inside(px + bx, py + by) || !inside(qx + bx, qy + by)) continue;
          for (std::size_t c = 0; c < 3; ++c)
            distance += std::pow(y[c](px + bx, py + by) - y[c](qx + bx, qy + by), 2);
        }
      }
      distance /= 3.0 * (2 * f + 1) * (2 * f + 1);
      const double w = std::exp(-distance / (2.0 * sigma * sigma)) * feature_weight(px, py, qx, qy);
      sum += w * target(qx, qy);
      total += w;
    }
  }
  return sum / total;
}

// (F - y)^2 + 2 v dF/dy - v, mean over channels.
inline double cross_patch_risk(RgbImage y, const RgbImage& v,
                               const std::function<double(int, int, int, int)>& feature_weight,
                               double sigma, const CrossPatchOptions& options, int px, int py) {
  double risk = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto mean = [&] {
      return cross_patch_mean(y, y[c], feature_weight, sigma, options, px, py);
    };
    const double value = y[c](px, py), f = mean(), step = 1e-5 * sigma;
    y[c](px, py) = value + step;
    const double above = mean();
    y[c](px, py) = value - step;
    const double slope = (above - mean()) / (2.0 * step);
    y[c](px, py) = value;
    risk += ((f - value) * (f - value) + (2.0 * slope - 1.0) * v[c](px, py)) / 3.0;
  }
  return risk;
}

}  // namespace spool::reference
