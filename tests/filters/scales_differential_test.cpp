// Truncated filters, the oracle's scales, the structure tensor and wavelet shrinkage against their
// slow twins.
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "lib/filters/directional/structure_tensor.h"
#include "lib/filters/oracle_scale.h"
#include "lib/filters/wavelet_shrinkage.h"
#include "lib/kernels/piece_estimates.h"
#include "lib/kernels/truncated_filter.h"
#include "tests/filters/small_pools.h"
#include "tests/reference/oracle_scale_reference.h"
#include "tests/reference/structure_tensor_reference.h"
#include "tests/reference/test_images.h"
#include "tests/reference/truncated_filter_reference.h"
#include "tests/reference/wavelet_transform_reference.h"
#include "tests/support/sizes.h"

namespace spool {
namespace {

using testing::make_pool;
using testing::noisy_picture;
using testing::select_counts;

TEST(TruncatedFilterDifferential, MeansAndVariancesAgreeWithTheSlowTwin) {
  const Taps uneven{-1, {0.2, 0.5, 0.1, 0.4}};
  for (const auto& [width, height] : test::twin_sizes()) {
    const Plane image = reference::noise_image(width, height, 3);
    Plane variance = image;
    for (double& v : variance.pixels())
      v *= v;
    for (const Taps& taps :
         {floor_gaussian_taps(0.7), floor_gaussian_taps(2.0), pixel_filter_taps(), uneven}) {
      EXPECT_LT(reference::max_difference(truncated_mean(image, taps),
                                          reference::truncated_filter(image, taps, 1)),
                1e-14)
          << width << "x" << height;
      EXPECT_LT(reference::max_difference(truncated_variance(variance, taps, squared_taps(taps)),
                                          reference::truncated_filter(variance, taps, 2)),
                1e-14)
          << width << "x" << height;
    }
  }
}

TEST(OracleScaleDifferential, TheChosenScaleHasTheLeastErrorOfTheSlowTwin) {
  for (const auto& [width, height] : test::twin_sizes()) {
    const SamplePool pool = make_pool(width, height, 8, noisy_picture(width, height, 7));
    const Selection selection = select_counts(pool, [](int x, int y) { return 2 + (x + y) % 5; });
    RgbImage truth = make_rgb(width, height);
    for (std::size_t c = 0; c < 3; ++c)
      truth[c] = reference::noise_image(width, height, 20 + c);
    const Reference reference{truth, std::nullopt};
    FilterContext context;
    context.reference = &reference;
    for (const double smoothing : {0.0, 1.0}) {
      const auto result = reconstruct_oracle_scale(selection, pool, {6, smoothing}, context);
      ASSERT_TRUE(result.has_value());
      const auto twin = reference::oracle_scale(selection.statistics.mean, truth, 6, smoothing);
      for (std::size_t i = 0; i < truth[0].size(); ++i) {
        const auto chosen = static_cast<std::size_t>((*result->level)[i]);
        for (std::size_t s = 0; s <= 6; ++s)
          ASSERT_LE(twin.error[chosen][i], twin.error[s][i] + 1e-13) << width << "x" << height;
        for (std::size_t c = 0; c < 3; ++c)
          ASSERT_NEAR(result->image[c][i], twin.candidates[chosen][c][i], 1e-13);
      }
    }
  }
}

TEST(StructureTensorDifferential, EnergiesAreThoseOfTheDerivativeAcrossEachDirection) {
  const std::array<double, 5> angles = {0.0, 13.28, 45.0, 90.0, 144.22};
  for (const auto& [width, height] : test::twin_sizes()) {
    PyramidOptions of_pyramid;
    of_pyramid.levels = 2;
    const Pyramid pyramid = build_pyramid(reference::noise_image(width, height, 9), of_pyramid);
    DirectionalOptions options;
    options.pyramid = of_pyramid;
    options.energy.noise_correct = false;
    options.energy.stand_out = 0.0;
    for (const int level : {1, 2}) {
      GuardCounts guards;
      const auto energy = structure_tensor_energy<double>(pyramid, Plane(width, height, 0.1), level,
                                                          angles, options, guards);
      const double sigma = options.energy.smoothing * std::pow(2.0, level);
      for (std::size_t a = 0; a < angles.size(); ++a) {
        const Plane twin = reference::structure_energy(
            pyramid.coarse[static_cast<std::size_t>(level - 1)], angles[a], sigma);
        EXPECT_LT(reference::max_difference(energy.energy[a], twin), 1e-14)
            << width << "x" << height << " " << angles[a];
      }
    }
  }
}

// White noise has no energy left on average, whatever the direction.
TEST(StructureTensor, NoiseIsSubtracted) {
  const std::array<double, 2> angles = {0.0, 45.0};
  DirectionalOptions options;
  options.base = BaseImage::kNone;
  options.energy.smoothing = 3.0;
  options.energy.stand_out = 0.0;
  Plane noise = reference::noise_image(200, 150, 4);  // variance 1/3
  options.pyramid.levels = 1;
  const Pyramid pyramid = build_pyramid(noise, options.pyramid);
  for (const bool corrected : {false, true}) {
    options.energy.noise_correct = corrected;
    GuardCounts guards;
    const auto energy = structure_tensor_energy<double>(pyramid, Plane(200, 150, 1.0 / 3.0), 1,
                                                        angles, options, guards);
    for (const Plane& plane : energy.energy) {
      double mean = 0.0;
      for (const double e : plane.pixels())
        mean += e / static_cast<double>(plane.size());
      if (corrected) {
        EXPECT_LT(mean, 0.02);  // what is left is the positive half of the fluctuations
      } else {
        EXPECT_NEAR(mean, 0.5 / 3.0, 0.01);
      }
    }
  }
}

// Every direction gets `stand_out` times the noise.
TEST(StructureTensor, NoiseIsAddedToEveryDirection) {
  const std::array<double, 2> angles = {0.0, 45.0};
  DirectionalOptions options;
  options.base = BaseImage::kNone;
  options.pyramid.levels = 1;
  const Pyramid pyramid = build_pyramid(reference::noise_image(40, 30, 4), options.pyramid);
  const auto energies = [&](double stand_out) {
    options.energy.stand_out = stand_out;
    GuardCounts guards;
    return structure_tensor_energy<double>(pyramid, Plane(40, 30, 1.0 / 3.0), 1, angles, options,
                                           guards)
        .energy;
  };
  const auto plain = energies(0.0), raised = energies(2.0);
  for (std::size_t a = 0; a < angles.size(); ++a) {
    for (std::size_t i = 0; i < plain[a].size(); ++i)
      ASSERT_NEAR(raised[a][i] - plain[a][i], 2.0 * 0.5 / 3.0, 1e-12);
  }
}

// The slow transform of the shrunk image is the shrunk slow transform: both are one to one where
// the image needs no padding.
TEST(WaveletShrinkageDifferential, CoefficientsOfTheResultAreTheShrunkOnes) {
  for (const auto& [width, height, levels] :
       {std::array{2, 2, 1}, {6, 10, 1}, {16, 14, 1}, {4, 8, 2}, {12, 16, 2}, {64, 8, 3}}) {
    const SamplePool pool = make_pool(width, height, 8, noisy_picture(width, height, 2));
    const Selection selection = select_counts(pool, [](int x, int y) { return 4 + (x * y) % 4; });
    GuardCounts guards;
    const double exposure = analysis_exposure(selection.statistics, guards);
    const auto pieces = estimate_pieces(selection.statistics, {}, exposure, guards);
    const auto transform = [&](const Plane& image, int power) {
      Plane out = image;
      for (int l = 0; l < levels; ++l) {
        Plane corner(image.width() >> l, image.height() >> l);
        for (int y = 0; y < corner.height(); ++y) {
          for (int x = 0; x < corner.width(); ++x)
            corner(x, y) = out(x, y);
        }
        corner = reference::forward_level(corner, power);
        for (int y = 0; y < corner.height(); ++y) {
          for (int x = 0; x < corner.width(); ++x)
            out(x, y) = corner(x, y);
        }
      }
      return out;
    };
    WaveletShrinkageOptions options;
    options.levels = levels;
    options.lambda = 1.3;
    const auto result = reconstruct_wavelet_shrinkage(selection, pool, options, {});
    ASSERT_TRUE(result.has_value());
    for (std::size_t c = 0; c < 3; ++c) {
      const Plane w = transform(pieces->mean[c], 1), v = transform(pieces->variance[c], 2);
      const Plane after = transform(result->image[c], 1);
      for (int l = 1; l <= levels; ++l) {
        const int bw = width >> l, bh = height >> l;
        for (const auto& [bx, by] : {std::pair{1, 0}, {0, 1}, {1, 1}}) {
          for (int y = by * bh; y < (by + 1) * bh; ++y) {
            for (int x = bx * bw; x < (bx + 1) * bw; ++x) {
              const double size = std::abs(w(x, y)), sign = w(x, y) < 0.0 ? -1.0 : 1.0;
              const double sigma = std::sqrt(v(x, y));
              const double expected = sign * std::max(0.0, size - 1.3 * sigma);
              ASSERT_NEAR(after(x, y), expected, 1e-11) << width << "x" << height << " " << l;
            }
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace spool
