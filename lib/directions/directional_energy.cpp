#include "lib/directions/directional_energy.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lib/core/parallel.h"
#include "lib/core/vector_clones.h"
#include "lib/pyramid/convolution.h"

namespace spool {
namespace {

template <class T>
SPOOL_VECTOR_CLONES void measure_row(const T* from, bool absolute, int width, T* __restrict to) {
  if (absolute) {
    for (int x = 0; x < width; ++x)
      to[x] = std::abs(from[x]);
  } else {
    for (int x = 0; x < width; ++x)
      to[x] = from[x] * from[x];
  }
}

// row = max(row - gain noise, 0), row squared first where it is a mean of absolute values;
// largest: the largest such value of each piece so far. Returns how many were negative.
template <class T>
SPOOL_VECTOR_CLONES std::int64_t take_noise_off(const T* noise, double gain, bool square_first,
                                                int width, T* __restrict row,
                                                double* __restrict largest) {
  std::int64_t negative = 0;
  for (int x = 0; x < width; ++x) {
    const auto value = static_cast<double>(row[x]);
    const double measured = square_first ? value * value : value;
    const double left = measured - gain * static_cast<double>(noise[x]);
    negative += left < 0.0 ? 1 : 0;
    const double square = left < 0.0 ? 0.0 : left;
    largest[x] = square > largest[x] ? square : largest[x];
    row[x] = static_cast<T>(square);
  }
  return negative;
}

// G_s * D^2, or G_s * |D|, in the place of D.
template <class T>
void smooth_measure(Image<T>& band, DirectionMeasure measure, const Taps& gaussian,
                    Extension extension, Image<T>& scratch) {
  parallel_rows(0, scratch.height(), [&](int y) {
    measure_row(band.row(y).data(), measure == DirectionMeasure::kAbs, scratch.width(),
                scratch.row(y).data());
  });
  convolve_box(scratch, gaussian, 1, extension, scratch.bounds(), band);
}

template <class T>
Image<T> smoothed_noise(const Plane& variance, const Taps& gaussian, Extension extension,
                        Image<T>& scratch) {
  parallel_rows(0, scratch.height(), [&](int y) {
    for (int x = 0; x < scratch.width(); ++x)
      scratch(x, y) = static_cast<T>(variance(x, y));
  });
  Image<T> noise(variance.width(), variance.height());
  convolve_box(scratch, gaussian, 1, extension, scratch.bounds(), noise);
  return noise;
}

}  // namespace

template <class T>
DirectionalEnergy<T> directional_energy(NoisyBands<T> source, const Plane& variance, int level,
                                        const EnergyOptions& options, GuardCounts& guards) {
  SPOOL_CHECK_GE(level, 1);
  const std::size_t bands = source.bands.size();
  SPOOL_CHECK_EQ(source.gains.size(), bands);
  double mean_gain = 0.0;
  for (const double gain : source.gains)
    mean_gain += gain / static_cast<double>(bands);

  const int width = variance.width(), height = variance.height();
  const Taps gaussian = gaussian_taps(options.smoothing * std::ldexp(1.0, level));
  Image<T> scratch(width, height);
  const Image<T> noise = smoothed_noise(variance, gaussian, options.extension, scratch);
  DirectionalEnergy<T> result;
  result.isotropic = Image<std::uint8_t>(width, height);
  result.energy = std::move(source.bands);
  for (Image<T>& band : result.energy) {
    SPOOL_CHECK(band.same_size(variance));
    smooth_measure(band, options.measure, gaussian, options.extension, scratch);
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
      const double gain = options.noise_correct ? noise_share * source.gains[i] : 0.0;
      const auto negative = static_cast<std::uint64_t>(
          take_noise_off(smooth_noise, gain, is_abs, width, row, largest.data()));
      if (is_abs) {
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

template DirectionalEnergy<double> directional_energy(NoisyBands<double>, const Plane&, int,
                                                      const EnergyOptions&, GuardCounts&);
template DirectionalEnergy<float> directional_energy(NoisyBands<float>, const Plane&, int,
                                                     const EnergyOptions&, GuardCounts&);

OptionTable<EnergyOptions> energy_option_table() {
  using O = EnergyOptions;
  return {
      expert(choice_option<O, DirectionMeasure>(
          "dir_measure", &O::measure,
          {{"energy", DirectionMeasure::kEnergy}, {"abs", DirectionMeasure::kAbs}},
          "measure of a direction's strength")),
      expert(switch_option<O>("noise_correct", &O::noise_correct,
                              "subtract the noise that a band carries")),
      expert(number_option<O>("dir_smoothing", &O::smoothing, 0.0, 4.0,
                              "smoothing of the band energies, in units of 2^k pieces")),
      number_option<O>("stand_out", &O::stand_out, 0.0, 1e3,
                       "multiples of the noise that a direction has to stand out of (of the "
                       "structure tensor)"),
  };
}

}  // namespace spool
