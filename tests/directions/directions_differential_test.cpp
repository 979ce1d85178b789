// The fast directional filter bank and energies against their slow twins.
#include <gtest/gtest.h>

#include "lib/directions/directional_energy.h"
#include "lib/directions/directional_filter_bank.h"
#include "tests/reference/directional_energy_reference.h"
#include "tests/reference/directional_filter_bank_reference.h"
#include "tests/reference/test_images.h"

namespace spool {
namespace {

using reference::firefly_image;
using reference::max_abs;
using reference::max_difference;

void expect_bands_match(const Plane& image, const BankOptions& options) {
  const auto fast = directional_bands(image, options);
  const auto slow = reference::directional_bands(image, options);
  ASSERT_EQ(fast.size(), slow.size());
  for (std::size_t i = 0; i < fast.size(); ++i) {
    ASSERT_LE(max_difference(fast[i], slow[i]), 1e-12 * max_abs(image))
        << image.width() << "x" << image.height() << " band " << i;
  }
}

TEST(DirectionalFilterBankDifferential, EverySizeMatchesTheTwin) {
  for (const int size : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 31, 64}) {
    BankOptions options;
    options.dilation = size % 3 + 1;
    expect_bands_match(firefly_image(size, 18 - size % 17, 71), options);
  }
}

TEST(DirectionalFilterBankDifferential, EveryOptionMatchesTheTwin) {
  const Plane image = firefly_image(23, 11, 72);
  for (const SignTaps taps : {SignTaps::kPkva6, SignTaps::kPkva8, SignTaps::kPkva12}) {
    for (const Extension extension :
         {Extension::kSymmetric, Extension::kClamp, Extension::kPeriodic, Extension::kWhole}) {
      for (int levels = 0; levels <= 3; ++levels) {
        for (const int dilation : {1, 4}) {
          expect_bands_match(image, {levels, dilation, taps, extension});
        }
      }
    }
  }
}

// float32 keeps seven digits of the image's range through three stages.
TEST(DirectionalFilterBankDifferential, FloatBandsMatchTheDoubleOnes) {
  const Plane image = firefly_image(64, 31, 73);
  Image<float> single(64, 31);
  for (std::size_t i = 0; i < image.size(); ++i)
    single[i] = static_cast<float>(image[i]);
  const auto wide = reference::directional_bands(image, BankOptions{});
  const auto narrow = directional_bands(single, BankOptions{});
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_LE(max_difference(narrow[i], wide[i]), 1e-6 * max_abs(image));
  }
}

TEST(DirectionalEnergyDifferential, EveryOptionAndLevelMatchesTheTwin) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 7}, {21, 34}}) {
    Plane variance = firefly_image(width, height, 75);
    for (double& value : variance.pixels())
      value = std::abs(value) * 1e-7;
    for (int level = 1; level <= 4; ++level) {
      BankOptions bank;
      bank.dilation = detail_dilation(level - 1);
      const NoisyBands<double> noisy = {directional_bands(firefly_image(width, height, 74), bank),
                                        {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8}};
      for (const auto measure : {DirectionMeasure::kEnergy, DirectionMeasure::kAbs}) {
        for (const bool correct : {true, false}) {
          EnergyOptions options;
          options.measure = measure;
          options.noise_correct = correct;
          GuardCounts guards;
          const auto fast = directional_energy<double>(noisy, variance, level, options, guards);
          const auto slow = reference::directional_energy(noisy, variance, level, options);
          EXPECT_EQ(fast.isotropic, slow.isotropic);
          for (std::size_t i = 0; i < 8; ++i) {
            EXPECT_LE(max_difference(fast.energy[i], slow.energy[i]),
                      1e-12 * std::max(max_abs(slow.energy[i]), 1e-6));
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace spool
