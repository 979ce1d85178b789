// Slow twin of lib/statistics/grown_variance.h: every window summed by itself.
#pragma once

#include <algorithm>

#include "lib/core/image.h"

namespace spool::reference {

inline Plane grown_variance(const Plane& v, int largest, const Plane* mean = nullptr) {
  Plane out(v.width(), v.height());
  for (int y = 0; y < v.height(); ++y) {
    for (int x = 0; x < v.width(); ++x) {
      double left = 1.0, smaller = 0.0;
      for (int r = 1; r <= largest; r *= 2) {
        double sum = 0.0, squares = 0.0, count = 0.0, means = 0.0, spread = 0.0;
        const auto for_window = [&](auto&& body) {
          for (int qy = std::max(y - r, 0); qy <= std::min(y + r, v.height() - 1); ++qy) {
            for (int qx = std::max(x - r, 0); qx <= std::min(x + r, v.width() - 1); ++qx)
              body(qx, qy);
          }
        };
        for_window([&](int qx, int qy) {
          sum += v(qx, qy), squares += v(qx, qy) * v(qx, qy), count += 1.0;
          if (mean) means += (*mean)(qx, qy);
        });
        if (mean) {
          for_window([&](int qx, int qy) {
            const double d = (*mean)(qx, qy) - means / count;
            spread += d * d / (count - 1.0);
          });
        }
        double alike = 1.0;
        if (mean && count > 1.0)
          alike = sum > 0.0 ? std::clamp(2.0 - spread / (sum / count), 0.0, 1.0) : 0.0;
        const double pieces = squares > 0.0 ? sum * sum / squares : 0.0;
        const double enough = 2 * r > largest ? 1.0 : std::clamp((pieces - 10.0) / 10.0, 0.0, 1.0);
        out(x, y) += left * (alike * enough * sum / count + (1.0 - alike) * smaller);
        left *= alike * (1.0 - enough);
        smaller = sum / count;
      }
    }
  }
  return out;
}

}  // namespace spool::reference
