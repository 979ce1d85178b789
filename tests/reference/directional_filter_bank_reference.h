// Slow twin of lib/directions/directional_filter_bank.h: the defining double sum of every stage.
#pragma once

#include <vector>

#include "lib/core/extend.h"
#include "lib/core/image.h"
#include "lib/directions/directional_filter_bank.h"

namespace spool::reference {

struct Vector2 {
  int x, y;
};

// (Bx)(n) = - sum_a sum_b tap(a) tap(b) x(ext(n - (a + 1/2) p - (b + 1/2) q))
template <class T>
Image<T> sign_product(const Image<T>& image, Vector2 p, Vector2 q, const BankOptions& options) {
  const auto s = sign_coefficients(options.taps);
  const int pairs = static_cast<int>(s.size());
  const auto tap = [&](int a) {
    return static_cast<T>(a >= 0 ? s[static_cast<std::size_t>(a)]
                                 : -s[static_cast<std::size_t>(-a - 1)]);
  };
  const int d = options.dilation;
  Image<T> out(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      T sum = 0;
      for (int a = -pairs; a < pairs; ++a) {
        for (int b = -pairs; b < pairs; ++b) {
          // Twice the offset is an even integer because p + q is even.
          const int offset_x = d * ((2 * a + 1) * p.x + (2 * b + 1) * q.x) / 2;
          const int offset_y = d * ((2 * a + 1) * p.y + (2 * b + 1) * q.y) / 2;
          sum += tap(a) * tap(b) *
                 image(extend(x - offset_x, image.width(), options.extension),
                       extend(y - offset_y, image.height(), options.extension));
        }
      }
      out(x, y) = -sum;
    }
  }
  return out;
}

template <class T>
struct Channels {
  Image<T> plus, minus;
};

template <class T>
Channels<T> split(const Image<T>& image, Vector2 p, Vector2 q, const BankOptions& options) {
  const Image<T> product = sign_product(image, p, q, options);
  Channels<T> channels{image, image};
  for (std::size_t i = 0; i < image.size(); ++i) {
    channels.plus[i] = T{0.5} * (image[i] + product[i]);
    channels.minus[i] = T{0.5} * (image[i] - product[i]);
  }
  return channels;
}

// In T: double is the twin, long double measures the double's rounding.
template <class T>
std::vector<Image<T>> directional_bands(const Image<T>& image, const BankOptions& options) {
  if (options.levels == 0) return {image};
  const auto [h, v] = split(image, {1, 1}, {1, -1}, options);
  if (options.levels == 1) return {h, v};
  const auto [h_up, h_down] = split(h, {2, 0}, {0, 2}, options);
  const auto [v_up, v_down] = split(v, {2, 0}, {0, 2}, options);
  if (options.levels == 2) return {h_up, v_up, v_down, h_down};
  const auto [band1, band0] = split(h_up, {-1, 2}, {1, 0}, options);
  const auto [band2, band3] = split(v_up, {2, -1}, {0, 1}, options);
  const auto [band5, band4] = split(v_down, {2, 1}, {0, -1}, options);
  const auto [band6, band7] = split(h_down, {1, 2}, {-1, 0}, options);
  return {band0, band1, band2, band3, band4, band5, band6, band7};
}

}  // namespace spool::reference
