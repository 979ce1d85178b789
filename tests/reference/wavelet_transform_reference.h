// Slow twin of lib/filters/wavelet_transform.h: one level of the 9-7 transform as the
// definition of its four filters, on the image extended by whole-sample symmetry.
#pragma once

#include <cmath>

#include "lib/core/extend.h"
#include "lib/core/image.h"
#include "lib/pyramid/wavelet_filters.h"

namespace spool::reference {

// h0(n) = sqrt 2 H(n); g0(n) = G(n) / sqrt 2; h1(n) = (-1)^{n-1} g0(n - 1): analysis keeps the even
// outputs of convolution, so h1 looks at odd samples, one to the left. Shifted here to the right
// one.
inline double analysis_tap(bool high, int n) {
  const FilterPair pair = filter_pair(WaveletFilter::k97);
  const Taps& taps = high ? pair.synthesis : pair.analysis;
  if (n < taps.first || n > taps.last()) return 0.0;
  const double value = taps.values[static_cast<std::size_t>(n - taps.first)];
  if (!high) return std::sqrt(2.0) * value;
  return (n % 2 == 0 ? 1.0 : -1.0) * value / std::sqrt(2.0);
}

// One level on the whole image; power 2 squares the filters.
inline Plane forward_level(const Plane& image, int power) {
  const int width = image.width(), height = image.height();
  Plane out(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool high_x = x >= width / 2, high_y = y >= height / 2;
      const int cx = 2 * (x - (high_x ? width / 2 : 0)) + (high_x ? 1 : 0);
      const int cy = 2 * (y - (high_y ? height / 2 : 0)) + (high_y ? 1 : 0);
      double sum = 0.0;
      for (int j = -4; j <= 4; ++j) {
        for (int i = -4; i <= 4; ++i) {
          sum += std::pow(analysis_tap(high_x, i) * analysis_tap(high_y, j), power) *
                 image(extend(cx - i, width, Extension::kWhole),
                       extend(cy - j, height, Extension::kWhole));
        }
      }
      out(x, y) = sum;
    }
  }
  return out;
}

}  // namespace spool::reference
