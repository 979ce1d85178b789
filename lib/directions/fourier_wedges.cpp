#include "lib/directions/fourier_wedges.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "lib/core/parallel.h"
#include "lib/directions/directional_filter_bank.h"
#include "lib/directions/fourier.h"

namespace spool {
namespace {

constexpr double kRampHalfWidth = 8.0;  // degrees

// 0 below -8 degrees, 1 above +8, cos^2 between.
double ramp(double difference) {
  const double t = std::clamp(difference / kRampHalfWidth, -1.0, 1.0);
  return 0.5 * (1.0 + std::sin(0.5 * std::numbers::pi * t));
}

int period_of(int n, Extension extension) {
  switch (extension) {
    case Extension::kPeriodic:
      return n;
    case Extension::kWhole:
      return std::max(2 * n - 2, 1);
    default:
      return 2 * n;
  }
}

// Weight at frequency index (kx, ky) of a px x py period. At the Nyquist index the sign of the
// frequency is open: the mean of both keeps the response real.
double weight_at(int levels, int band, int kx, int ky, int px, int py) {
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

}  // namespace

double wedge_weight(int levels, int band, double angle) {
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

template <class T>
void fourier_wedge_bands(const Image<T>& image, int levels, Extension extension,
                         std::vector<Image<T>>& bands) {
  SPOOL_CHECK(extension != Extension::kClamp);
  SPOOL_CHECK_EQ(bands.size(), std::size_t{1} << levels);
  const int px = period_of(image.width(), extension), py = period_of(image.height(), extension);
  const auto stride = static_cast<std::size_t>(px);
  std::vector<std::complex<double>> spectrum(stride * static_cast<std::size_t>(py));
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x);
  };
  for (int y = 0; y < py; ++y) {
    for (int x = 0; x < px; ++x) {
      spectrum[at(x, y)] = static_cast<double>(
          image(extend(x, image.width(), extension), extend(y, image.height(), extension)));
    }
  }
  fourier_transform_2d(spectrum, px, py, FourierDirection::kForward);
  // Responses are real and even, so a band is real: two bands share one transform.
  for (std::size_t i = 0; i < bands.size(); i += 2) {
    std::vector<std::complex<double>> pair(spectrum.size());
    parallel_rows(0, py, [&](int y) {
      for (int x = 0; x < px; ++x) {
        const std::complex<double> weight = {
            weight_at(levels, static_cast<int>(i), x, y, px, py),
            weight_at(levels, static_cast<int>(i) + 1, x, y, px, py)};
        pair[at(x, y)] = spectrum[at(x, y)] * weight;
      }
    });
    fourier_transform_2d(pair, px, py, FourierDirection::kInverse);
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        bands[i](x, y) = static_cast<T>(pair[at(x, y)].real());
        bands[i + 1](x, y) = static_cast<T>(pair[at(x, y)].imag());
      }
    }
  }
}

template void fourier_wedge_bands(const Image<double>&, int, Extension,
                                  std::vector<Image<double>>&);
template void fourier_wedge_bands(const Image<float>&, int, Extension, std::vector<Image<float>>&);

}  // namespace spool
