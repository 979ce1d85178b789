// Slow twin of lib/pyramid/region_mean.h: the defining sum over the clipped square.
#pragma once

#include "lib/core/image.h"

namespace spool::reference {

inline Plane region_mean(const Plane& image, int level) {
  Plane out(image.width(), image.height());
  const int half = level == 0 ? 0 : 1 << (level - 1);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      double sum = 0.0;
      int count = 0;
      for (int v = y - half; v <= (level == 0 ? y : y + half - 1); ++v) {
        for (int u = x - half; u <= (level == 0 ? x : x + half - 1); ++u) {
          if (u < 0 || v < 0 || u >= image.width() || v >= image.height()) continue;
          sum += image(u, v);
          ++count;
        }
      }
      out(x, y) = sum / count;
    }
  }
  return out;
}

}  // namespace spool::reference
