// Slow twin of lib/kernels/truncated_filter.h: every window by itself, both dimensions at once.
#pragma once

#include "lib/core/image.h"
#include "lib/pyramid/wavelet_filters.h"

namespace spool::reference {

// power 1: the mean over the window's part inside the image; power 2: its variance.
inline Plane truncated_filter(const Plane& image, const Taps& taps, int power) {
  Plane out(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      double sum = 0.0, inside = 0.0;
      for (int n = taps.first; n <= taps.last(); ++n) {
        for (int m = taps.first; m <= taps.last(); ++m) {
          if (x - m < 0 || y - n < 0 || x - m >= image.width() || y - n >= image.height()) continue;
          const double w = taps.values[static_cast<std::size_t>(m - taps.first)] *
                           taps.values[static_cast<std::size_t>(n - taps.first)];
          inside += w;
          sum += (power == 1 ? w : w * w) * image(x - m, y - n);
        }
      }
      out(x, y) = sum / (power == 1 ? inside : inside * inside);
    }
  }
  return out;
}

}  // namespace spool::reference
