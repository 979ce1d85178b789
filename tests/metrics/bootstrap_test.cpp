#include "lib/metrics/bootstrap.h"

#include <gtest/gtest.h>

#include "lib/metrics/energy_masks.h"
#include "lib/metrics/error_metrics.h"
#include "tests/support/random_images.h"

namespace spool {
namespace {

using test::add_noise;
using test::normal;

TEST(BlockBootstrap, EveryResampleDrawsAsManyBlocksAsThereAre) {
  const BlockBootstrap bootstrap(70, 33);
  EXPECT_EQ(bootstrap.blocks(), 5 * 3);
  for (int r = 0; r < bootstrap.resamples(); ++r)
    EXPECT_EQ(weighted_sum(std::vector<double>(15, 1.0), bootstrap.weights(r)), 15.0);
}

TEST(BlockBootstrap, BlocksTileTheImage) {
  const BlockBootstrap bootstrap(70, 33);
  CountImage seen(70, 33);
  for (int b = 0; b < bootstrap.blocks(); ++b) {
    const Rectangle bounds = bootstrap.block_bounds(b);
    for (int y = bounds.y0; y < bounds.y1; ++y) {
      for (int x = bounds.x0; x < bounds.x1; ++x) {
        ++seen(x, y);
        EXPECT_EQ(bootstrap.block_of(x, y), b);
      }
    }
  }
  for (const int n : seen.pixels())
    EXPECT_EQ(n, 1);
}

TEST(BlockBootstrap, DrawsAreUniform) {
  BootstrapOptions options;
  options.resamples = 2000;
  const BlockBootstrap bootstrap(64, 64, options);
  double chi_square = 0.0;
  for (int b = 0; b < 16; ++b) {
    double drawn = 0.0;
    for (int r = 0; r < 2000; ++r)
      drawn += bootstrap.weights(r)[static_cast<std::size_t>(b)];
    chi_square += (drawn - 2000.0) * (drawn - 2000.0) / 2000.0;
  }
  EXPECT_LT(chi_square, 37.7);  // 15 degrees of freedom, significance 0.001
}

// Standard error of the MSE of white noise: sigma^2 sqrt(2 / (3 N)) for N pixels of 3 channels.
TEST(BlockBootstrap, StandardErrorOfWhiteNoiseMseIsThatOfTheory) {
  const RgbImage r = make_rgb(256, 256, 1.0);
  const RgbImage i = add_noise(r, 17, 0.3);
  BootstrapOptions bootstrap;
  bootstrap.resamples = 2000;
  MetricOptions options;
  options.bootstrap = bootstrap;
  const MetricValue mse = error_metrics(i, {r, {}, {}}, options)["mse"];
  const double theory = 0.09 * std::sqrt(2.0 / (3.0 * 256 * 256));
  // 256 blocks and 2000 resamples: relative standard deviation about 0.05; 3.5 of them.
  EXPECT_NEAR(mse.standard_error / theory, 1.0, 0.175);
  EXPECT_LT(std::abs(mse.value - 0.09), 4 * theory);
}

// Noise constant over 16x16 blocks: single pixels would claim an error 16 times too small.
TEST(BlockBootstrap, StandardErrorKnowsThatPixelsOfABlockAreAlike) {
  const RgbImage r = make_rgb(320, 320, 1.0);
  const RgbImage i = test::make_image(320, 320, [](int x, int y, int c) {
    return 1.0 + 0.3 * normal(5, static_cast<std::uint64_t>(y / 16 * 20 + x / 16),
                              static_cast<std::uint64_t>(c));
  });
  const double theory = 0.09 * std::sqrt(2.0 / (3.0 * 400));
  EXPECT_NEAR(error_metrics(i, {r, {}, {}})["mse"].standard_error / theory, 1.0, 0.25);
}

TEST(BlockBootstrap, StandardErrorOfTheEnergyRatioIsThatOfTheRatio) {
  // I = R exactly: numerator and denominator vary together and the ratio does not vary at all.
  const RgbImage r = test::uniform_image(128, 128, 3);
  EXPECT_LT(error_metrics(r, {r, {}, {}})["energy_ratio"].standard_error, 1e-14);
  // White noise on a flat reference: sigma / sqrt(3 N).
  const RgbImage flat = make_rgb(256, 256, 1.0);
  const MetricValue ratio = error_metrics(add_noise(flat, 23, 0.5), {flat, {}, {}})["energy_ratio"];
  const double theory = 0.5 / std::sqrt(3.0 * 256 * 256);
  EXPECT_NEAR(ratio.standard_error / theory, 1.0, 0.25);
  EXPECT_LT(std::abs(ratio.value - 1.0), 4 * theory);
}

TEST(BlockBootstrap, StandardErrorDividesByOneLessThanTheFiniteValues) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_DOUBLE_EQ(standard_error_of(std::vector<double>{1.0, none, 3.0}), std::sqrt(2.0));
  EXPECT_TRUE(std::isnan(standard_error_of(std::vector<double>{1.0, none})));
}

TEST(BlockBootstrap, OneBlockHasNoStandardError) {
  const RgbImage r = test::uniform_image(16, 16, 3);
  EXPECT_TRUE(std::isnan(error_metrics(add_noise(r, 4, 0.1), {r, {}, {}})["mse"].standard_error));
}

// The image has several blocks, what is averaged lies in one: resamples say nothing of its error.
TEST(BlockBootstrap, WhatLiesInOneBlockHasNoStandardError) {
  const RgbImage r = test::uniform_image(20, 20, 3), i = add_noise(r, 4, 0.1);
  const MetricTable small = error_metrics(i, {r, {}, {}});
  EXPECT_GT(small["mse"].standard_error, 0.0);
  for (const char* name : {"ssim", "ms_ssim"})  // centres of whole windows: 5 .. 14
    EXPECT_TRUE(std::isnan(small[name].standard_error)) << name;
  RgbImage holed = make_rgb(20, 20, std::nan(""));
  for (std::size_t c = 0; c < 3; ++c) {
    for (int x = 0; x < 16; ++x)
      holed[c](x, 3) = i[c](x, 3);
  }
  for (const char* name : {"mse", "relmse_trimmed", "energy_ratio", "psnr_tm", "flip_ldr"})
    EXPECT_TRUE(std::isnan(error_metrics(holed, {r, {}, {}})[name].standard_error)) << name;
  EnergyMask mask{"m", "", "m.exr", Plane(20, 20)};
  for (int x = 0; x < 16; ++x)
    mask.plane(x, 3) = 1.0;
  EXPECT_TRUE(std::isnan(energy_in_mask(i, r, mask)->standard_error));
  mask.plane(16, 3) = 1.0;
  EXPECT_GT(energy_in_mask(i, r, mask)->standard_error, 0.0);
}

TEST(BlockBootstrap, RatioOfSumsEqualsTheRatio) {
  const BlockBootstrap bootstrap(48, 16);
  const std::vector<double> numerator = {1.0, 2.0, 3.0}, denominator = {2.0, 2.0, 2.0};
  const Estimate estimate = ratio_of_sums(bootstrap, numerator, denominator);
  EXPECT_EQ(estimate.value, 1.0);
  // Mean of 3 values of variance 2/3 over 4: resampling sd sqrt(2/3 / 4 / 3).
  EXPECT_NEAR(estimate.standard_error, std::sqrt(2.0 / 3.0 / 4.0 / 3.0), 0.05);
}

}  // namespace
}  // namespace spool
