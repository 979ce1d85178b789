// A Gaussian blur with every weight by itself.
#pragma once

#include <cmath>

#include "lib/core/extend.h"
#include "lib/core/image.h"

namespace spool::reference {

// Gaussian of `sigma` taps, cut at `reach`, mirrored at the border.
inline Plane blur_within(const Plane& image, double sigma, int reach, int dilation = 1) {
  Plane out(image.width(), image.height());
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      double sum = 0.0, total = 0.0;
      for (int j = -reach; j <= reach; ++j) {
        for (int i = -reach; i <= reach; ++i) {
          const double w = std::exp(-(i * i + j * j) / (2.0 * sigma * sigma));
          sum += w * image(extend_symmetric(x + i * dilation, out.width()),
                           extend_symmetric(y + j * dilation, out.height()));
          total += w;
        }
      }
      out(x, y) = sum / total;
    }
  }
  return out;
}

inline Plane blur(const Plane& image, double sigma, int dilation = 1) {
  return blur_within(image, sigma, static_cast<int>(std::lround(4.0 * sigma)), dilation);
}

}  // namespace spool::reference
