// Images for tests: noise from counter-based random numbers, and distances between images.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "lib/core/image.h"
#include "lib/core/random.h"

namespace spool::reference {

// Uniform in [-1, 1), a pure function of (seed, x, y).
inline Plane noise_image(int width, int height, std::uint64_t seed) {
  Plane image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      image(x, y) = 2.0 * unit_double(mix(seed, x, y)) - 1.0;
  }
  return image;
}

// Noise with a few pixels a million times brighter.
inline Plane firefly_image(int width, int height, std::uint64_t seed) {
  Plane image = noise_image(width, height, seed);
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (mix(seed, 77, i) % 101 == 0) image[i] *= 1e6;
  }
  return image;
}

template <class T>
double max_abs(const Image<T>& image) {
  double result = 0.0;
  for (const T value : image.pixels())
    result = std::max(result, std::abs(double{value}));
  return result;
}

template <class T, class U>
double max_difference(const Image<T>& a, const Image<U>& b) {
  double result = a.same_size(b) ? 0.0 : INFINITY;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    const double difference = std::abs(double{a[i]} - double{b[i]});
    if (!(difference <= result)) result = difference;  // keeps NaN
  }
  return result;
}

template <class T>
Image<T> mirrored_x(const Image<T>& image) {
  Image<T> out(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x)
      out(image.width() - 1 - x, y) = image(x, y);
  }
  return out;
}

template <class T>
Image<T> transposed(const Image<T>& image) {
  Image<T> out(image.height(), image.width());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x)
      out(y, x) = image(x, y);
  }
  return out;
}

}  // namespace spool::reference
