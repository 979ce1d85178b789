#include "lib/directions/directional_energy.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "lib/directions/band_noise_gains.h"
#include "lib/pyramid/convolution.h"
#include "tests/reference/test_images.h"

namespace spool {
namespace {

// Standard normal by Box and Muller, a pure function of (seed, x, y).
Plane gaussian_noise(int width, int height, std::uint64_t seed) {
  Plane image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double u = 1.0 - unit_double(mix(seed, 1, x, y)), v = unit_double(mix(seed, 2, x, y));
      image(x, y) = std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
    }
  }
  return image;
}

BankOptions bank_of_level(int level) {
  BankOptions options;
  options.dilation = detail_dilation(level - 1);
  return options;
}

template <class T = double>
NoisyBands<T> bands_of_level(const Plane& image, int level, const PyramidOptions& options = {}) {
  const Plane detail = build_pyramid(image, options).detail[static_cast<std::size_t>(level - 1)];
  Image<T> converted(detail.width(), detail.height());
  for (std::size_t i = 0; i < detail.size(); ++i)
    converted[i] = static_cast<T>(detail[i]);
  return {directional_bands(converted, bank_of_level(level)),
          band_noise_gains(options, bank_of_level(level), level)};
}

TEST(BandNoiseGains, WithoutABankTheyAreTheSquaresOfTheDetailKernel) {
  // d_0 = delta - K with K = (g/2) * h separable: gain = (1 - k0^2)^2-type sums of one dimension.
  for (const WaveletFilter filter : {WaveletFilter::k53, WaveletFilter::k97, WaveletFilter::kDb3}) {
    const auto [h, g] = filter_pair(filter);
    std::vector<double> kernel(h.values.size() + g.values.size() - 1, 0.0);
    for (std::size_t a = 0; a < h.values.size(); ++a) {
      for (std::size_t b = 0; b < g.values.size(); ++b) {
        kernel[a + b] += 0.5 * h.values[a] * g.values[b];
      }
    }
    double squares = 0.0;
    for (const double value : kernel)
      squares += value * value;
    const double centre = kernel[static_cast<std::size_t>(-h.first - g.first)];
    PyramidOptions pyramid;
    pyramid.filter = filter;
    BankOptions none;
    none.levels = 0;
    const double expected = 1.0 - 2.0 * centre * centre + squares * squares;
    EXPECT_NEAR(band_noise_gains(pyramid, none, 1)[0], expected, 1e-14);
  }
}

TEST(BandNoiseGains, PrefilterIsPartOfTheResponse) {
  PyramidOptions pyramid;
  const BankOptions bank = bank_of_level(2);
  const Taps prefilter = {-1, {0.1, 0.8, 0.1}};
  const auto gains = band_noise_gains(pyramid, bank, 2, prefilter);
  Plane delta(400, 400);
  delta(200, 200) = 1.0;
  pyramid.levels = 2;
  const auto bands =
      directional_bands(build_pyramid(convolve(delta, prefilter), pyramid).detail[1], bank);
  for (std::size_t i = 0; i < 8; ++i) {
    double sum = 0.0;
    for (const double value : bands[i].pixels())
      sum += value * value;
    EXPECT_NEAR(gains[i], sum, 1e-14);
  }
}

TEST(BandNoiseGains, ResponseDoesNotWrapOntoItself) {
  // The gains of one period equal those of a far larger one.
  PyramidOptions pyramid;
  BankOptions bank = bank_of_level(2);
  const auto gains = band_noise_gains(pyramid, bank, 2);
  Plane delta(400, 400);
  delta(200, 200) = 1.0;
  pyramid.levels = 2;
  const auto bands = directional_bands(build_pyramid(delta, pyramid).detail[1], bank);
  for (std::size_t i = 0; i < 8; ++i) {
    double sum = 0.0;
    for (const double value : bands[i].pixels())
      sum += value * value;
    EXPECT_NEAR(gains[i], sum, 1e-14);
  }
}

// White noise of variance 4: the mean of D_i^2 is 4 g_i. The mean over 256^2 correlated pixels has
// a standard error below 3 %; with the 16 means tested at 5 standard errors, alpha < 1e-5.
TEST(BandNoiseGains, ArePredictedByWhiteNoise) {
  for (const LaplacianDetail detail : {LaplacianDetail::kCycleSpun, LaplacianDetail::kPhase00}) {
    PyramidOptions pyramid;
    pyramid.detail = detail;
    Plane image = gaussian_noise(256, 256, 61);
    for (double& value : image.pixels())
      value *= 2.0;
    for (int level = 1; level <= 2; ++level) {
      const NoisyBands<double> noisy = bands_of_level(image, level, pyramid);
      for (std::size_t i = 0; i < 8; ++i) {
        double mean = 0.0;
        for (const double value : noisy.bands[i].pixels())
          mean += value * value / 65536.0;
        EXPECT_NEAR(mean / (4.0 * noisy.gains[i]), 1.0, level == 1 ? 0.06 : 0.12)
            << level << " " << i;
      }
    }
  }
}

TEST(DirectionalEnergy, OfASmoothStripedImageIsLargestAcrossTheStripes) {
  Plane stripes(96, 96);
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 96; ++x)
      stripes(x, y) = std::cos(1.3 * x + 0.4 * y);  // 17.1 degrees
  }
  const NoisyBands<double> noisy = bands_of_level(stripes, 1);
  for (const auto measure : {DirectionMeasure::kEnergy, DirectionMeasure::kAbs}) {
    GuardCounts guards;
    EnergyOptions options;
    options.measure = measure;
    const auto result = directional_energy<double>(noisy, Plane(96, 96, 1e-6), 1, options, guards);
    ASSERT_EQ(result.energy.size(), 8u);
    for (int y = 8; y < 88; ++y) {
      for (int x = 8; x < 88; ++x) {
        EXPECT_EQ(result.isotropic(x, y), 0);
        for (std::size_t i = 1; i < 8; ++i)
          EXPECT_GT(result.energy[0](x, y), result.energy[i](x, y));
      }
    }
    EXPECT_EQ(guards[Guard::kIsotropicFallback], 0u);
  }
}

TEST(DirectionalEnergy, BlackImageIsIsotropicEverywhereAndCounted) {
  const NoisyBands<double> noisy = bands_of_level(Plane(20, 10), 1);
  GuardCounts guards;
  const auto result =
      directional_energy<double>(noisy, Plane(20, 10, 0.5), 1, EnergyOptions{}, guards);
  for (const auto flag : result.isotropic.pixels())
    EXPECT_EQ(flag, 1);
  for (const Plane& energy : result.energy)
    EXPECT_EQ(reference::max_abs(energy), 0.0);
  EXPECT_EQ(guards[Guard::kIsotropicFallback], 200u);
  EXPECT_EQ(guards[Guard::kNegativeBandEnergy], 1600u);
}

// What rounding leaves of a constant is no direction, whatever the noise is said to be.
TEST(DirectionalEnergy, StripesOfTheSizeOfRoundingAreIsotropicAndCounted) {
  Plane stripes(24, 16), faint(24, 16);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 24; ++x) {
      stripes(x, y) = 1e-7 * std::cos(1.3 * x + 0.4 * y);
      faint(x, y) = 1e-4 * stripes(x, y);
    }
  }
  GuardCounts guards;
  const NoisyBands<double> seen = bands_of_level(stripes, 1), unseen = bands_of_level(faint, 1);
  const Plane no_noise(24, 16);
  const auto directed = directional_energy<double>(seen, no_noise, 1, {}, guards);
  EXPECT_EQ(guards[Guard::kIsotropicFallback], 0u);
  const auto round = directional_energy<double>(unseen, no_noise, 1, {}, guards);
  EXPECT_EQ(guards[Guard::kIsotropicFallback], 24u * 16);
  for (std::size_t p = 0; p < no_noise.size(); ++p) {
    EXPECT_EQ(directed.isotropic[p], 0);
    EXPECT_EQ(round.isotropic[p], 1);
  }
}

// The correction removes what noise adds: over pure noise the smoothed energy less its expectation
// has mean 0; uncorrected it has mean g v.
TEST(DirectionalEnergy, NoiseCorrectionSubtractsTheNoiseEnergy) {
  const NoisyBands<double> noisy = bands_of_level(gaussian_noise(128, 128, 62), 1);
  EnergyOptions on, off;
  off.noise_correct = false;
  GuardCounts guards_on, guards_off;
  const Plane variance(128, 128, 1.0);
  const auto corrected = directional_energy<double>(noisy, variance, 1, on, guards_on);
  const auto plain = directional_energy<double>(noisy, variance, 1, off, guards_off);
  std::uint64_t below = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    for (std::size_t p = 0; p < variance.size(); ++p) {
      const double left = plain.energy[i][p] - noisy.gains[i];
      below += left < -1e-12 ? 1u : 0u;
      ASSERT_NEAR(corrected.energy[i][p], std::max(left, 0.0), 1e-12);
    }
  }
  EXPECT_EQ(guards_on[Guard::kNegativeBandEnergy], below);
  EXPECT_GT(below, 8u * 128 * 128 / 4);
  EXPECT_EQ(guards_off[Guard::kNegativeBandEnergy], 0u);
}

}  // namespace
}  // namespace spool
