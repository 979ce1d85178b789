// Arithmetic of linear colours: the sRGB curve, and matrices from one space of three primaries to
// another.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace spool {

using ColourMatrix = std::array<std::array<double, 3>, 3>;  // [to][from]

// sRGB transfer function of a linear value in [0, 1] [IEC61966].
inline double srgb_encoded(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

// Not finite where the rows depend on one another.
inline ColourMatrix inverse(const ColourMatrix& m) {
  const auto minor = [&](std::size_t r, std::size_t c) {  // the cyclic order carries the sign
    const std::size_t r0 = (r + 1) % 3, r1 = (r + 2) % 3, c0 = (c + 1) % 3, c1 = (c + 2) % 3;
    return m[r0][c0] * m[r1][c1] - m[r0][c1] * m[r1][c0];
  };
  const double det = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
  ColourMatrix result{};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c)
      result[r][c] = minor(c, r) / det;
  }
  return result;
}

}  // namespace spool
