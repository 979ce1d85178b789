#include <gtest/gtest.h>

#include <cmath>

#include "lib/directions/directional_filter_bank.h"
#include "tests/reference/fourier_wedges.h"
#include "tests/reference/test_images.h"

namespace spool {
namespace {

TEST(FourierWedges, WeightsSumToOneAtEveryAngle) {
  for (int levels = 1; levels <= 3; ++levels) {
    for (int step = 0; step < 1800; ++step) {
      double sum = 0.0;
      for (int i = 0; i < 1 << levels; ++i)
        sum += reference::wedge_weight(levels, i, 0.1 * step);
      EXPECT_NEAR(sum, 1.0, 1e-12) << levels << " " << step;
    }
  }
}

TEST(FourierWedges, BandsSumToTheImage) {
  const Plane image = reference::noise_image(37, 20, 51);
  for (const Extension extension :
       {Extension::kSymmetric, Extension::kPeriodic, Extension::kWhole}) {
    Plane sum(37, 20);
    for (const Plane& band : reference::fourier_wedge_bands(image, 3, extension)) {
      for (std::size_t i = 0; i < sum.size(); ++i)
        sum[i] += band[i];
    }
    EXPECT_LE(reference::max_difference(sum, image), 1e-13);
  }
}

// Two banks built on different ideas agree on what lies where: their bands of one noise image are
// correlated with their namesakes and hardly with the others.
TEST(FourierWedges, BandsMatchThoseOfTheFilterBank) {
  const Plane image = reference::noise_image(96, 96, 52);
  BankOptions options;
  options.extension = Extension::kPeriodic;
  const auto tree = directional_bands(image, options);
  const auto wedges = reference::fourier_wedge_bands(image, options.levels, options.extension);
  const auto product = [](const Plane& a, const Plane& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
      sum += a[i] * b[i];
    return sum;
  };
  for (std::size_t i = 0; i < 8; ++i) {
    for (std::size_t j = 0; j < 8; ++j) {
      const double correlation =
          product(tree[i], wedges[j]) /
          std::sqrt(product(tree[i], tree[i]) * product(wedges[j], wedges[j]));
      if (i == j) {
        EXPECT_GT(correlation, 0.8) << i;
      } else {
        EXPECT_LT(std::abs(correlation), 0.35) << i << " " << j;
      }
    }
  }
}

}  // namespace
}  // namespace spool
