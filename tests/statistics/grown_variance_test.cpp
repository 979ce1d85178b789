// Pooled variances: the slow twin, rare light, and a lamp that must not leak.
#include "lib/statistics/grown_variance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "lib/core/random.h"
#include "tests/reference/grown_variance_reference.h"
#include "tests/reference/test_images.h"

namespace spool {
namespace {

// Eight samples a piece, one in thirty of them 1; nothing else.
struct RareLight {
  Plane mean, variance;
  RareLight(int width, int height) : mean(width, height), variance(width, height, 1e-18) {
    for (std::size_t i = 0; i < mean.size(); ++i) {
      double bright = 0.0;
      for (std::uint64_t s = 0; s < 8; ++s)
        bright += unit_double(mix(5, i, s)) < 1.0 / 30.0 ? 1.0 : 0.0;
      mean[i] = bright / 8.0;
      variance[i] += mean[i] * (1.0 - mean[i]) / 7.0;
    }
  }
};

TEST(GrownVariance, EqualsItsSlowTwin) {
  for (const auto& [width, height] :
       {std::pair{1, 1}, {1, 9}, {9, 1}, {2, 3}, {17, 13}, {40, 33}}) {
    RareLight rare(width, height);
    Plane other = reference::noise_image(width, height, 3);
    for (std::size_t i = 0; i < other.size(); ++i)
      other[i] = (i % 7 == 0 ? 0.5 : 0.01) * other[i];
    for (const int radius : {1, 2, 5, 8, 64}) {
      for (const Plane* mean : {static_cast<Plane*>(nullptr), &rare.mean, &other}) {
        const Plane fast = grown_variance(rare.variance, radius, mean);
        const Plane slow = reference::grown_variance(rare.variance, radius, mean);
        ASSERT_LT(reference::max_difference(fast, slow), 1e-12 * reference::max_abs(slow) + 1e-30)
            << width << "x" << height << " " << radius;
      }
    }
  }
}

TEST(GrownVariance, APieceAloneIsLikeItself) {
  const Plane mean(1, 1, 2.0), variance(1, 1, 0.25);
  for (const int radius : {1, 2, 8})
    EXPECT_EQ(grown_variance(variance, radius, &mean)[0], 0.25);
}

// Where 25 pieces are dark in every sample nothing tells rare light from black.
TEST(GrownVariance, HardlyAPieceOfRareLightIsWithoutNoise) {
  const RareLight rare(64, 64);
  const double expected = 1.0 / 30.0 * 29.0 / 30.0 / 8.0;
  const auto without_noise = [&](const Plane& variance) {
    return std::count_if(variance.pixels().begin(), variance.pixels().end(),
                         [&](double v) { return v < 0.2 * expected; });
  };
  const Plane grown = grown_variance(rare.variance, 8, &rare.mean);
  EXPECT_GT(without_noise(rare.variance), 64 * 64 / 2);
  EXPECT_LT(without_noise(grown), 64 * 64 / 10);
  EXPECT_LT(reference::max_abs(grown), 4.0 * expected);
}

// A lamp of 50 whose rim is half covered, on a floor of 1 that has little noise.
TEST(GrownVariance, TheNoiseOfALampsRimStaysThere) {
  Plane mean(48, 48, 1.0), variance(48, 48, 1e-4);
  for (int y = 20; y < 28; ++y) {
    for (int x = 20; x < 28; ++x) {
      const bool rim = x == 20 || x == 27 || y == 20 || y == 27;
      mean(x, y) = rim ? 25.0 : 50.0;
      variance(x, y) = rim ? 90.0 : 1e-4;
    }
  }
  const Plane leaks = grown_variance(variance, 8), kept = grown_variance(variance, 8, &mean);
  EXPECT_GT(leaks(19, 24), 1.0);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 48; ++x) {
      if (mean(x, y) == 1.0) {
        EXPECT_LT(kept(x, y), 2e-4) << x << " " << y;
      }
    }
  }
}

}  // namespace
}  // namespace spool
