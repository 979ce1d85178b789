// Images of counter-based random numbers for tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "lib/core/image.h"
#include "lib/core/random.h"

namespace spool::test {

inline double uniform(std::uint64_t seed, std::uint64_t a, std::uint64_t b = 0) {
  return unit_double(mix(seed, a, b));
}

// Standard normal by Box and Muller.
inline double normal(std::uint64_t seed, std::uint64_t a, std::uint64_t b = 0) {
  const double u = 1.0 - unit_double(mix(seed, a, b, 1)), v = unit_double(mix(seed, a, b, 2));
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
}

// term(x, y, c) for every pixel and channel.
template <class Term>
RgbImage make_image(int width, int height, Term&& term) {
  RgbImage image = make_rgb(width, height);
  for (int c = 0; c < 3; ++c) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x)
        image[static_cast<std::size_t>(c)](x, y) = term(x, y, c);
    }
  }
  return image;
}

inline RgbImage uniform_image(int width, int height, std::uint64_t seed, double low = 0.0,
                              double high = 1.0) {
  return make_image(width, height, [&](int x, int y, int c) {
    return low + (high - low) * uniform(seed, static_cast<std::uint64_t>(y * width + x),
                                        static_cast<std::uint64_t>(c));
  });
}

inline RgbImage add_noise(const RgbImage& image, std::uint64_t seed, double sigma) {
  RgbImage noisy = image;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t p = 0; p < noisy[c].size(); ++p)
      noisy[c][p] += sigma * normal(seed, p, c);
  }
  return noisy;
}

}  // namespace spool::test
