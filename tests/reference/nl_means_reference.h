// Slow twin of the weights of lib/kernels/patch_filter.h: every patch of every pair by itself.
#pragma once

#include <algorithm>
#include <cmath>

#include "lib/core/extend.h"
#include "lib/kernels/patch_filter.h"

namespace spool::reference {

inline RgbImage filter_with_guide(const RgbImage& target, const HalfImage& guide,
                                  const PatchFilterOptions& options) {
  const int width = target[0].width(), height = target[0].height();
  const auto at = [&](const Plane& plane, int x, int y) {
    return plane(extend_symmetric(x, width), extend_symmetric(y, height));
  };
  const int f = options.patch;
  const double patch = (2 * f + 1) * (2 * f + 1);
  const auto distance = [&](int px, int py, int dx, int dy) {
    double sum = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double a = at(guide.mean[c], px, py) - at(guide.mean[c], px + dx, py + dy);
      const double vp = at(guide.variance[c], px, py);
      const double vq = at(guide.variance[c], px + dx, py + dy);
      sum += (a * a - options.alpha * (vp + std::min(vq, vp))) /
             (1e-10 + options.kappa * options.kappa * (vp + vq));
    }
    return sum / 3.0;
  };
  const auto patch_weight = [&](int px, int py, int dx, int dy) {
    double sum = 0.0;
    for (int j = -f; j <= f; ++j) {
      for (int i = -f; i <= f; ++i)
        sum += distance(px + i, py + j, dx, dy);
    }
    return std::exp(-std::max(0.0, sum / patch));
  };
  RgbImage out = target;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double total = 0.0, value[3] = {};
      for (int dy = -options.window; dy <= options.window; ++dy) {
        for (int dx = -options.window; dx <= options.window; ++dx) {
          double w = 0.0;
          for (int j = -f; j <= f; ++j) {
            for (int i = -f; i <= f; ++i)
              w += patch_weight(x + i, y + j, dx, dy) / patch;
          }
          if (w < 0.05) w = 0.0;
          if (dx == 0 && dy == 0) w = 1.0;
          total += w;
          for (std::size_t c = 0; c < 3; ++c)
            value[c] += w * at(target[c], x + dx, y + dy);
        }
      }
      for (std::size_t c = 0; c < 3; ++c)
        out[c](x, y) = value[c] / total;
    }
  }
  return out;
}

}  // namespace spool::reference
