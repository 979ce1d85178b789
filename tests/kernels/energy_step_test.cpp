#include "lib/kernels/energy_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lib/core/pairwise_sum.h"
#include "tests/reference/energy_step_reference.h"
#include "tests/reference/test_images.h"
#include "tests/support/random_images.h"
#include "tests/support/thread_count.h"

namespace spool {
namespace {

double sum_of(const Plane& plane) {
  return pairwise_sum(plane.size(), [&](std::size_t i) { return plane[i]; });
}

TEST(EnergyStepDifferential, AgreesWithTheSlowTwin) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 8}, {13, 1}, {12, 17}}) {
    const RgbImage out = test::uniform_image(width, height, 1, -0.1, 2.0);
    const RgbImage mean = test::uniform_image(width, height, 2, 0.0, 3.0);
    for (const double sigma : {0.5, 1.7, 32.0}) {
      for (const double top : {1.0, std::numeric_limits<double>::infinity()}) {
        GuardCounts guards;
        const RgbImage fast =
            restore_energy(out, mean, 0.7, {.sigma = sigma, .floor = 0.8, .top = top}, guards);
        for (std::size_t c = 0; c < 3; ++c) {
          const Plane slow =
              reference::restore_energy(out[c], mean[c], sigma, 0.8 * 0.7, top * 0.7);
          EXPECT_LT(reference::max_difference(fast[c], slow), 1e-12) << width << " x " << height;
        }
      }
    }
  }
}

TEST(EnergyStep, SumIsThatOfTheMean) {
  for (const double unit : {0x1p-20, 1.0, 0x1p20}) {
    const RgbImage out = test::uniform_image(150, 90, 1, 0.0, unit);
    const RgbImage mean = test::uniform_image(150, 90, 2, 0.0, 5.0 * unit);
    GuardCounts guards;
    const RgbImage restored = restore_energy(out, mean, unit, {}, guards);
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(sum_of(restored[c]) / sum_of(mean[c]), 1.0, 1e-13);
  }
}

TEST(EnergyStep, ChangesNothingWhereNothingIsLost) {
  const RgbImage mean = test::uniform_image(40, 30, 4);
  GuardCounts guards;
  EXPECT_TRUE(restore_energy(mean, mean, 1.0, {}, guards) == mean);
}

TEST(EnergyStep, BrightPixelsTakeMoreOfWhatIsMissing) {
  RgbImage out = make_rgb(9, 9, 0.1);
  out[0](4, 4) = 5.0;
  RgbImage mean = out;
  for (double& v : mean[0].pixels())
    v += 0.1;
  GuardCounts guards;
  const RgbImage restored = restore_energy(out, mean, 0.1, {.sigma = 2.0}, guards);
  EXPECT_GT(restored[0](4, 4) - 5.0, 100.0 * (restored[0](3, 4) - 0.1));
  EXPECT_GT(restored[0](3, 4), 0.1);
}

TEST(EnergyStep, PixelThatIsNotFiniteTakesNoPart) {
  RgbImage out = test::uniform_image(20, 20, 7), mean = test::uniform_image(20, 20, 8, 0.0, 2.0);
  out[1](5, 6) = std::numeric_limits<double>::quiet_NaN();
  mean[1](9, 9) = std::numeric_limits<double>::infinity();
  GuardCounts guards;
  const RgbImage restored = restore_energy(out, mean, 1.0, {}, guards);
  EXPECT_EQ(guards[Guard::kEnergyNotFinite], 2u);
  EXPECT_TRUE(std::isnan(restored[1](5, 6)));
  EXPECT_EQ(restored[1](9, 9), out[1](9, 9));
  double given = 0.0, wanted = 0.0;
  for (std::size_t i = 0; i < restored[1].size(); ++i) {
    if (!std::isfinite(out[1][i] + mean[1][i])) continue;
    given += restored[1][i];
    wanted += mean[1][i];
  }
  EXPECT_NEAR(given, wanted, 1e-10);
}

TEST(EnergyStepDeterminism, SameBitsForAnyNumberOfThreads) {
  const RgbImage out = test::uniform_image(91, 70, 1), mean = test::uniform_image(91, 70, 2);
  const auto run = [&](int threads) {
    return test::with_threads(threads, [&] {
      GuardCounts guards;
      return restore_energy(out, mean, 1.0, {}, guards);
    });
  };
  const RgbImage one = run(1);
  for (const int threads : {2, 3, 8})
    EXPECT_TRUE(run(threads) == one) << threads << " threads";
}

}  // namespace
}  // namespace spool
