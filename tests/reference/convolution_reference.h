// Slow twin of lib/pyramid/convolution.h: the defining double sum at every pixel.
#pragma once

#include "lib/core/extend.h"
#include "lib/core/image.h"
#include "lib/pyramid/wavelet_filters.h"

namespace spool::reference {

template <class T>
T convolve_at(const Image<T>& in, const Taps& taps, int dilation, Extension extension, int x,
              int y) {
  T sum = 0;
  for (int n = taps.first; n <= taps.last(); ++n) {
    for (int m = taps.first; m <= taps.last(); ++m) {
      sum += static_cast<T>(taps.values[static_cast<std::size_t>(n - taps.first)]) *
             static_cast<T>(taps.values[static_cast<std::size_t>(m - taps.first)]) *
             in(extend(x - m * dilation, in.width(), extension),
                extend(y - n * dilation, in.height(), extension));
    }
  }
  return sum;
}

template <class T>
Image<T> convolve(const Image<T>& in, const Taps& taps, int dilation, Extension extension) {
  Image<T> out(in.width(), in.height());
  for (int y = 0; y < in.height(); ++y) {
    for (int x = 0; x < in.width(); ++x) {
      out(x, y) = convolve_at(in, taps, dilation, extension, x, y);
    }
  }
  return out;
}

}  // namespace spool::reference
