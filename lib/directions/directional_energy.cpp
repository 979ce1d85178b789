#include "lib/directions/directional_energy.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lib/core/parallel.h"
#include "lib/pyramid/convolution.h"

namespace spool {
namespace {

// G_s * (sum over sources of D^2, or |D|) for one band.
template <class T>
Image<T> smoothed_measure(std::span<const NoisyBands<T>> sources, std::size_t band,
                          DirectionMeasure measure, const Taps& gaussian, Extension extension,
                          Image<T>& scratch) {
  parallel_rows(0, scratch.height(), [&](int y) {
    T* __restrict to = scratch.row(y).data();
    std::fill_n(to, scratch.width(), T{});
    for (const NoisyBands<T>& source : sources) {
      const T* from = source.bands[band].row(y).data();
      if (measure == DirectionMeasure::kAbs) {
        for (int x = 0; x < scratch.width(); ++x)
          to[x] += std::abs(from[x]);
      } else {
        for (int x = 0; x < scratch.width(); ++x)
          to[x] += from[x] * from[x];
      }
    }
  });
  Image<T> out(scratch.width(), scratch.height());
  convolve_box(scratch, gaussian, 1, extension, scratch.bounds(), out);
  return out;
}

// Sum of squares of the bands of d_{level-1} for a delta at (x, y) of an n x n image.
void add_response_energy(const PyramidOptions& pyramid, const BankOptions& bank, int level,
                         const Taps& prefilter, int n, int x, int y, double weight,
                         std::vector<double>& gains) {
  Plane delta(n, n);
  delta(x, y) = 1.0;
  delta = convolve(delta, prefilter, 1, Extension::kPeriodic);
  const Plane detail = build_pyramid(delta, pyramid).detail[static_cast<std::size_t>(level - 1)];
  const std::vector<Plane> bands = directional_bands(detail, bank);
  for (std::size_t i = 0; i < bands.size(); ++i) {
    double sum = 0.0;
    for (const double value : bands[i].pixels())
      sum += value * value;
    gains[i] += weight * sum;
  }
}

}  // namespace

template <class T>
DirectionalEnergy<T> directional_energy(std::span<const NoisyBands<T>> sources,
                                        const Plane& variance, int level,
                                        const EnergyOptions& options, GuardCounts& guards) {
  SPOOL_CHECK(!sources.empty());
  SPOOL_CHECK_GE(level, 1);
  const std::size_t bands = sources[0].bands.size();
  std::vector<double> gains(bands, 0.0);
  for (const NoisyBands<T>& source : sources) {
    SPOOL_CHECK_EQ(source.bands.size(), bands);
    SPOOL_CHECK_EQ(source.gains.size(), bands);
    for (std::size_t i = 0; i < bands; ++i) {
      SPOOL_CHECK(source.bands[i].same_size(variance));
      gains[i] += source.gains[i];
    }
  }
  double mean_gain = 0.0;
  for (const double gain : gains)
    mean_gain += gain / static_cast<double>(bands);

  const int width = variance.width(), height = variance.height();
  const Taps gaussian = gaussian_taps(options.smoothing * std::ldexp(1.0, level));
  Image<T> scratch(width, height), noise(width, height);
  parallel_rows(0, height, [&](int y) {
    for (int x = 0; x < width; ++x)
      scratch(x, y) = static_cast<T>(variance(x, y));
  });
  convolve_box(scratch, gaussian, 1, options.extension, scratch.bounds(), noise);

  DirectionalEnergy<T> result;
  result.isotropic = Image<std::uint8_t>(width, height);
  for (std::size_t i = 0; i < bands; ++i) {
    result.energy.push_back(
        smoothed_measure(sources, i, options.measure, gaussian, options.extension, scratch));
  }

  const bool is_abs = options.measure == DirectionMeasure::kAbs;
  const double noise_share = is_abs ? 2.0 / std::numbers::pi : 1.0;
  std::vector<GuardCounts> caught(static_cast<std::size_t>(height));
  parallel_rows(0, height, [&](int y) {
    GuardCounts& row_caught = caught[static_cast<std::size_t>(y)];
    std::vector<double> largest(static_cast<std::size_t>(width), 0.0);
    for (std::size_t i = 0; i < bands; ++i) {
      T* __restrict row = result.energy[i].row(y).data();
      const T* smooth_noise = noise.row(y).data();
      const double gain = options.noise_correct ? noise_share * gains[i] : 0.0;
      std::uint64_t negative = 0;
      for (int x = 0; x < width; ++x) {
        const double measured = is_abs ? double{row[x]} * row[x] : double{row[x]};
        const double left = measured - gain * double{smooth_noise[x]};
        negative += left < 0.0 ? 1u : 0u;
        const double square = left < 0.0 ? 0.0 : left;
        auto& most = largest[static_cast<std::size_t>(x)];
        most = square > most ? square : most;
        row[x] = static_cast<T>(square);
      }
      if (options.measure != DirectionMeasure::kEnergy) {
        for (int x = 0; x < width; ++x)
          row[x] = std::sqrt(row[x]);
      }
      row_caught.add(Guard::kNegativeBandEnergy, negative);
    }
    std::uint64_t round = 0;
    for (int x = 0; x < width; ++x) {
      const double most = largest[static_cast<std::size_t>(x)];
      const bool isotropic = most <= 1e-3 * mean_gain * double{noise(x, y)} || most <= 1e-20;
      result.isotropic(x, y) = isotropic ? 1 : 0;
      round += isotropic ? 1u : 0u;
    }
    row_caught.add(Guard::kIsotropicFallback, round);
  });
  for (const GuardCounts& row : caught)
    guards += row;
  return result;
}

template DirectionalEnergy<double> directional_energy(std::span<const NoisyBands<double>>,
                                                      const Plane&, int, const EnergyOptions&,
                                                      GuardCounts&);
template DirectionalEnergy<float> directional_energy(std::span<const NoisyBands<float>>,
                                                     const Plane&, int, const EnergyOptions&,
                                                     GuardCounts&);

std::vector<double> band_noise_gains(const PyramidOptions& pyramid_options,
                                     const BankOptions& bank_options, int level,
                                     const Taps& prefilter) {
  SPOOL_CHECK_GE(level, 1);
  PyramidOptions pyramid = pyramid_options;
  BankOptions bank = bank_options;
  pyramid.levels = level;
  pyramid.extension = Extension::kPeriodic;
  bank.extension = Extension::kPeriodic;

  // A period that holds the whole response, so that nothing wraps onto itself.
  PyramidOptions open = pyramid;
  open.extension = Extension::kClamp;
  const int far = 1 << 20;
  std::vector<Rectangle> coarse, detail;
  pyramid_influence({far, far, far + 1, far + 1}, {0, 0, 2 * far, 2 * far}, open, coarse, detail);
  const Rectangle reach = detail.back();
  const int pairs = static_cast<int>(sign_coefficients(bank.taps).size());
  const int stages = bank.levels * (bank.pair == ChannelPair::kLadder ? 2 : 1);
  const int bank_reach = stages * (2 * pairs - 1) * bank.dilation;
  const int prefilter_reach = static_cast<int>(prefilter.values.size());
  const int cell = 2 * pyramid_dilation(pyramid, level - 1);  // period of the phases
  const int n = (reach.width() + prefilter_reach + 2 * bank_reach + 3 * cell) / cell * cell;

  std::vector<double> gains(static_cast<std::size_t>(band_count(bank)), 0.0);
  if (pyramid.detail != LaplacianDetail::kPhase00) {
    add_response_energy(pyramid, bank, level, prefilter, n, n / 2, n / 2, 1.0, gains);
    return gains;
  }
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      add_response_energy(pyramid, bank, level, prefilter, n, i * cell / 2, j * cell / 2, 0.25,
                          gains);
    }
  }
  return gains;
}

OptionTable<EnergyOptions> energy_option_table() {
  using O = EnergyOptions;
  return {
      choice_option<O, DirectionMeasure>("dir_measure", &O::measure,
                                         {{"energy", DirectionMeasure::kEnergy},
                                          {"rms", DirectionMeasure::kRms},
                                          {"abs", DirectionMeasure::kAbs}},
                                         "measure of a direction's strength"),
      switch_option<O>("noise_correct", &O::noise_correct,
                       "subtract the noise that a band carries"),
      number_option<O>("dir_smoothing", &O::smoothing, 0.0, 4.0,
                       "smoothing of the band energies, in units of 2^k pieces"),
  };
}

}  // namespace spool
