// Slow twin of lib/directions/directional_energy.h in plain loops.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "lib/directions/directional_energy.h"
#include "tests/reference/convolution_reference.h"

namespace spool::reference {

inline DirectionalEnergy<double> directional_energy(const NoisyBands<double>& source,
                                                    const Plane& variance, int level,
                                                    const EnergyOptions& options) {
  const std::size_t bands = source.bands.size();
  const bool is_abs = options.measure == DirectionMeasure::kAbs;
  const Taps gaussian = gaussian_taps(options.smoothing * std::pow(2.0, level));
  const Plane noise = reference::convolve(variance, gaussian, 1, options.extension);
  DirectionalEnergy<double> result;
  for (const Plane& band : source.bands) {
    Plane measure = band;
    for (double& value : measure.pixels())
      value = is_abs ? std::abs(value) : value * value;
    result.energy.push_back(reference::convolve(measure, gaussian, 1, options.extension));
  }
  result.isotropic = Image<std::uint8_t>(variance.width(), variance.height());
  for (std::size_t p = 0; p < variance.size(); ++p) {
    double largest = 0.0, mean_noise = 0.0;
    for (std::size_t i = 0; i < bands; ++i) {
      double& e = result.energy[i][p];
      const double band_noise = source.gains[i] * noise[p];
      mean_noise += band_noise / static_cast<double>(bands);
      if (is_abs) e = e * e;
      if (options.noise_correct) e -= (is_abs ? 2.0 / std::numbers::pi : 1.0) * band_noise;
      e = std::max(e, 0.0);
      largest = std::max(largest, e);
      if (is_abs) e = std::sqrt(e);
    }
    result.isotropic[p] = largest <= 1e-3 * mean_noise || largest <= 1e-20;
  }
  return result;
}

}  // namespace spool::reference
