#include "lib/directions/fourier.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "lib/core/check.h"
#include "lib/core/parallel.h"

namespace spool {
namespace {

using Complex = std::complex<double>;

// exp(sign * 2 pi i numerator / denominator)
Complex root_of_unity(double sign, std::size_t numerator, std::size_t denominator) {
  const double angle = 2.0 * std::numbers::pi * static_cast<double>(numerator % denominator) /
                       static_cast<double>(denominator);
  return {std::cos(angle), sign * std::sin(angle)};
}

// Unscaled, in place; the length is a power of two.
void radix_two(std::vector<Complex>& values, double sign) {
  const std::size_t n = values.size();
  for (std::size_t i = 1, j = 0; i < n; ++i) {
    std::size_t bit = n >> 1;
    for (; (j & bit) != 0; bit >>= 1)
      j ^= bit;
    j ^= bit;
    if (i < j) std::swap(values[i], values[j]);
  }
  std::vector<Complex> roots(n / 2);
  for (std::size_t i = 0; i < n / 2; ++i)
    roots[i] = root_of_unity(sign, i, n);
  for (std::size_t length = 2; length <= n; length *= 2) {
    const std::size_t half = length / 2, step = n / length;
    for (std::size_t begin = 0; begin < n; begin += length) {
      for (std::size_t i = 0; i < half; ++i) {
        const Complex odd = values[begin + half + i] * roots[i * step];
        const Complex even = values[begin + i];
        values[begin + i] = even + odd;
        values[begin + half + i] = even - odd;
      }
    }
  }
}

// k n = (k^2 + n^2 - (k - n)^2) / 2 makes the transform a convolution with a chirp.
void chirp(std::vector<Complex>& values, double sign) {
  const std::size_t n = values.size(), padded = std::bit_ceil(2 * n - 1);
  std::vector<Complex> a(padded), b(padded);
  for (std::size_t i = 0; i < n; ++i) {
    const Complex factor = root_of_unity(sign, i * i, 2 * n);
    a[i] = values[i] * factor;
    b[i] = std::conj(factor);
    if (i > 0) b[padded - i] = b[i];
  }
  radix_two(a, -1.0);
  radix_two(b, -1.0);
  for (std::size_t i = 0; i < padded; ++i)
    a[i] *= b[i];
  radix_two(a, 1.0);
  for (std::size_t i = 0; i < n; ++i) {
    values[i] = a[i] / static_cast<double>(padded) * root_of_unity(sign, i * i, 2 * n);
  }
}

}  // namespace

void fourier_transform(std::vector<Complex>& values, FourierDirection direction) {
  if (values.size() <= 1) return;
  const double sign = direction == FourierDirection::kForward ? -1.0 : 1.0;
  if (std::has_single_bit(values.size())) {
    radix_two(values, sign);
  } else {
    chirp(values, sign);
  }
  if (direction == FourierDirection::kInverse) {
    for (Complex& value : values)
      value /= static_cast<double>(values.size());
  }
}

void fourier_transform_2d(std::vector<Complex>& values, int width, int height,
                          FourierDirection direction) {
  const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
  SPOOL_CHECK_EQ(values.size(), w * h);
  parallel_for(h, [&](std::size_t y) {
    std::vector<Complex> row(values.begin() + static_cast<std::ptrdiff_t>(y * w),
                             values.begin() + static_cast<std::ptrdiff_t>((y + 1) * w));
    fourier_transform(row, direction);
    std::copy(row.begin(), row.end(), values.begin() + static_cast<std::ptrdiff_t>(y * w));
  });
  parallel_for(w, [&](std::size_t x) {
    std::vector<Complex> column(h);
    for (std::size_t y = 0; y < h; ++y)
      column[y] = values[y * w + x];
    fourier_transform(column, direction);
    for (std::size_t y = 0; y < h; ++y)
      values[y * w + x] = column[y];
  });
}

}  // namespace spool
