// Directional bands by smooth wedges in the frequency plane: another idea of a filter bank, against
// which the tree is compared.
//
// Wedge weights have cos^2 ramps of half-width 8 degrees at the borders of band_borders() and sum
// to 1; the zero frequency is shared equally. The image is first extended to one period of its
// extension (symmetric: twice its size). Dilation has no meaning here: a wedge has no scale.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "lib/core/extend.h"
#include "lib/core/image.h"
#include "lib/directions/band_angles.h"

namespace spool::reference {

using ComplexImage = Image<std::complex<double>>;

// Rows, then columns, of the discrete Fourier transform by its definition; sign -1 is forward, +1
// inverse, which divides by the number of values.
inline ComplexImage fourier_transform(const ComplexImage& image, int sign) {
  ComplexImage result = image;
  const auto pass = [&](int lines, int n, auto&& at) {
    std::vector<std::complex<double>> turn(static_cast<std::size_t>(n)), line(turn.size());
    for (int i = 0; i < n; ++i)
      turn[static_cast<std::size_t>(i)] = std::polar(1.0, sign * 2.0 * std::numbers::pi * i / n);
    for (int l = 0; l < lines; ++l) {
      for (int k = 0; k < n; ++k) {
        std::complex<double> sum;
        for (int i = 0; i < n; ++i)
          sum += at(l, i) * turn[static_cast<std::size_t>(k) * static_cast<std::size_t>(i) %
                                 static_cast<std::size_t>(n)];
        line[static_cast<std::size_t>(k)] = sign > 0 ? sum / static_cast<double>(n) : sum;
      }
      for (int k = 0; k < n; ++k)
        at(l, k) = line[static_cast<std::size_t>(k)];
    }
  };
  pass(image.height(), image.width(),
       [&](int y, int x) -> std::complex<double>& { return result(x, y); });
  pass(image.width(), image.height(),
       [&](int x, int y) -> std::complex<double>& { return result(x, y); });
  return result;
}

// Weight of band i at a frequency angle in degrees.
inline double wedge_weight(int levels, int band, double angle) {
  // 0 below -8 degrees, 1 above +8, cos^2 between.
  const auto ramp = [](double difference) {
    const double t = std::clamp(difference / 8.0, -1.0, 1.0);
    return 0.5 * (1.0 + std::sin(0.5 * std::numbers::pi * t));
  };
  const std::vector<double> borders = band_borders(levels);
  const auto i = static_cast<std::size_t>(band);
  const double centre = band_frequency_angles(levels)[i];
  double width = borders[(i + 1) % borders.size()] - borders[i];
  if (width <= 0.0) width += 180.0;
  double difference = std::fmod(angle - centre, 180.0);
  if (difference < -90.0) difference += 180.0;
  if (difference >= 90.0) difference -= 180.0;
  return ramp(difference + 0.5 * width) * (1.0 - ramp(difference - 0.5 * width));
}

// Weight at frequency index (kx, ky) of a px x py period. At the Nyquist index the sign of the
// frequency is open: the mean of both keeps the response real.
inline double weight_at(int levels, int band, int kx, int ky, int px, int py) {
  if (kx == 0 && ky == 0) return 1.0 / static_cast<double>(1 << levels);
  const auto frequency = [](int k, int p) {
    return (2 * k <= p ? k : k - p) / static_cast<double>(p);
  };
  const double wx = frequency(kx, px), wy = frequency(ky, py);
  const auto weight = [&](double x) {
    return wedge_weight(levels, band, std::atan2(wy, x) * 180.0 / std::numbers::pi);
  };
  const bool open = 2 * kx == px || 2 * ky == py;
  return open ? 0.5 * (weight(wx) + weight(-wx)) : weight(wx);
}

// levels 1 .. 3; not for kClamp, which has no period.
inline std::vector<Plane> fourier_wedge_bands(const Plane& image, int levels, Extension extension) {
  const auto period_of = [&](int n) {
    if (extension == Extension::kPeriodic) return n;
    return extension == Extension::kWhole ? std::max(2 * n - 2, 1) : 2 * n;
  };
  const int px = period_of(image.width()), py = period_of(image.height());
  ComplexImage extended(px, py);
  for (int y = 0; y < py; ++y) {
    for (int x = 0; x < px; ++x) {
      extended(x, y) =
          image(extend(x, image.width(), extension), extend(y, image.height(), extension));
    }
  }
  const ComplexImage spectrum = fourier_transform(extended, -1);
  std::vector<Plane> bands;
  for (int i = 0; i < 1 << levels; ++i) {
    ComplexImage weighted = spectrum;
    for (int y = 0; y < py; ++y) {
      for (int x = 0; x < px; ++x)
        weighted(x, y) *= weight_at(levels, i, x, y, px, py);
    }
    weighted = fourier_transform(weighted, 1);
    Plane& band = bands.emplace_back(image.width(), image.height());
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x)
        band(x, y) = weighted(x, y).real();
    }
  }
  return bands;
}

}  // namespace spool::reference
