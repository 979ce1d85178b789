#include "lib/kernels/returned_residual.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/filters/small_pools.h"
#include "tests/reference/returned_residual_reference.h"
#include "tests/reference/test_images.h"
#include "tests/support/random_images.h"
#include "tests/support/thread_count.h"

namespace spool {
namespace {

// Values of about 1 with noise of the same size, and some a hundred times as bright.
Rgb noisy(double value, int x, int y, int s) {
  const double u = unit_double(mix(3, x, y, s));
  const double v = value * 2.0 * u * (mix(5, x, y, s) % 64 == 0 ? 100.0 : 1.0);
  return {static_cast<float>(v), static_cast<float>(0.5 * v), static_cast<float>(0.25 * v)};
}

std::vector<reference::HalvesOfPixel> halves_by_position(const Selection& selection,
                                                         const SamplePool& pool) {
  const CountImage& n = selection.statistics.n;
  const int q = pool.pieces_per_side(), width = n.width() / q;
  std::vector<reference::HalvesOfPixel> halves(n.size() / static_cast<std::size_t>(q * q));
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x) {
      reference::HalvesOfPixel& own = halves[static_cast<std::size_t>(y / q * width + x / q)];
      for (int i = 0; i < n(x, y); ++i) {
        const Rgb value = pool.sample(x, y, i);
        int half = i % 2;
        if (!selection.halves.empty())
          half = half_of_joined(selection.halves[0].statistics.n(x, y),
                                selection.halves[1].statistics.n(x, y), i);
        (half == 0 ? own.even : own.odd).push_back(luminance(value[0], value[1], value[2]));
      }
    }
  }
  return halves;
}

RgbImage returned(const RgbImage& image, const Selection& selection, const SamplePool& pool,
                  double unit) {
  GuardCounts guards;
  return return_residual(image, selection, pool, unit, guards);
}

void expect_twin(const RgbImage& image, const Selection& selection, const SamplePool& pool) {
  const RgbImage fast = returned(image, selection, pool, 0.7);
  const RgbImage slow = reference::return_residual(image, halves_by_position(selection, pool), 0.7);
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_LT(reference::max_difference(fast[c], slow[c]), 1e-12);
}

// Pixels from 1/1000 of the unit to a thousand times it: all hats.
RgbImage image_of_all_levels(int width, int height) {
  RgbImage image = test::uniform_image(width, height, 1, -7.0, 7.0);
  for (Plane& channel : image) {
    for (double& v : channel.pixels())
      v = std::exp(v);
  }
  return image;
}

TEST(ReturnedResidualDifferential, AgreesWithTheSlowTwin) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {60, 1}, {14, 47}}) {
    const SamplePool pool = testing::make_pool(
        width, height, 9, [](int x, int y, int s) { return noisy(1.0 + (x % 3), x, y, s); });
    const Selection selection =
        testing::select_counts(pool, [](int x, int y) { return (x * 5 + y * 3) % 10; });
    expect_twin(image_of_all_levels(width, height), selection, pool);
    expect_twin(test::uniform_image(width, height, 2, 0.5, 2.0), selection, pool);
  }
}

TEST(ReturnedResidualDifferential, JoinedHalvesAndPiecesToo) {
  const auto radiance = [](int x, int y, int s) { return noisy(1.0 + (x % 3), x, y, s); };
  const SamplePool pool = testing::make_pool(14, 11, 8, radiance);
  const Selection selection = testing::joined_halves(pool);
  expect_twin(test::uniform_image(14, 11, 2, 0.5, 2.0), selection, pool_of_joined(pool, selection));
  const SamplePool pieces =
      testing::make_pool(14, 11, 24, radiance, {.pieces_per_side = 2}, testing::random_film(24));
  expect_twin(test::uniform_image(14, 11, 2, 0.5, 2.0),
              testing::select_counts(pieces, [](int x, int y) { return (x + 3 * y) % 5; }), pieces);
}

// A texture that the image does not have: most of its error goes.
TEST(ReturnedResidual, DetailThatAFilterTookComesBack) {
  constexpr int kSize = 48, kSamples = 32;
  const auto truth = [](int x, int y) { return (x / 6 + y / 6) % 2 == 0 ? 0.4 : 1.6; };
  const auto radiance = [&](int x, int y, int s) {
    const auto v = static_cast<float>(truth(x, y) * 2.0 * unit_double(mix(4, x, y, s)));
    return Rgb{v, v, v};
  };
  const SamplePool pool = testing::make_pool(kSize, kSize, kSamples, radiance);
  const Selection selection = testing::select_uniform(pool, kSamples);
  const RgbImage flat = make_rgb(kSize, kSize, 1.0);
  const RgbImage image = returned(flat, selection, pool, 1.0);
  double before = 0.0, after = 0.0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      before += std::pow(flat[0](x, y) - truth(x, y), 2);
      after += std::pow(image[0](x, y) - truth(x, y), 2);
    }
  }
  EXPECT_LT(after, 0.3 * before);
}

// The image is the truth: what returns is noise, and little of it. One sample in a hundred carries
// most of the light.
TEST(ReturnedResidual, NoiseStaysAway) {
  constexpr int kSize = 64;
  for (const int samples : {2, 8}) {
    for (const double share : {1.0, 0.01}) {
      const auto radiance = [&](int x, int y, int s) {
        const bool bright = unit_double(mix(6, x, y, s)) < share;
        const auto v =
            static_cast<float>(bright ? 2.0 * unit_double(mix(7, x, y, s)) / share : 0.0);
        return Rgb{v, v, v};
      };
      const SamplePool pool = testing::make_pool(kSize, kSize, samples, radiance);
      const Selection selection = testing::select_uniform(pool, samples);
      GuardCounts guards;
      const RgbImage box = pixel_means(selection.statistics, guards);
      const RgbImage image = returned(make_rgb(kSize, kSize, 1.0), selection, pool, 1.0);
      double noise = 0.0, returned = 0.0;
      for (std::size_t p = 0; p < image[0].size(); ++p) {
        noise += std::pow(box[0][p] - 1.0, 2);
        returned += std::pow(image[0][p] - 1.0, 2);
      }
      EXPECT_LT(returned, 0.005 * noise) << samples << " " << share;
    }
  }
}

// A lamp without noise in front of a wall that few samples light.
TEST(ReturnedResidual, LampWithoutNoiseStaysAsItIs) {
  const auto lamp = [](int x, int y) { return x >= 16 && x < 24 && y >= 16 && y < 24; };
  const auto radiance = [&](int x, int y, int s) {
    const float dark = unit_double(mix(6, x, y, s)) < 0.05 ? 6.0f : 0.0f;
    const float v = lamp(x, y) ? 5.0f : dark;
    return Rgb{v, v, v};
  };
  const SamplePool pool = testing::make_pool(40, 40, 8, radiance);
  RgbImage image = make_rgb(40, 40, 0.3);
  for (Plane& channel : image) {
    for (int y = 16; y < 24; ++y) {
      for (int x = 16; x < 24; ++x)
        channel(x, y) = 5.0;
    }
  }
  const RgbImage out = returned(image, testing::select_uniform(pool, 8), pool, 0.3);
  for (int y = 17; y < 23; ++y) {
    for (int x = 17; x < 23; ++x)
      EXPECT_NEAR(out[0](x, y), 5.0, 0.05);
  }
}

TEST(ReturnedResidual, PowerOfTwoScalesTheResult) {
  for (const double factor : {0x1p-40, 0x1p30}) {
    const auto radiance = [](int x, int y, int s) { return noisy(1.0 + (x % 4), x, y, s); };
    const SamplePool pool = testing::make_pool(20, 15, 6, radiance);
    const SamplePool scaled_pool = testing::make_pool(20, 15, 6, [&](int x, int y, int s) {
      Rgb value = radiance(x, y, s);
      for (float& v : value)
        v *= static_cast<float>(factor);
      return value;
    });
    RgbImage image = test::uniform_image(20, 15, 3, 0.2, 3.0);
    RgbImage out = returned(image, testing::select_uniform(pool, 6), pool, 1.0);
    for (Plane& channel : image) {
      for (double& v : channel.pixels())
        v *= factor;
    }
    const RgbImage scaled =
        returned(image, testing::select_uniform(scaled_pool, 6), scaled_pool, factor);
    for (Plane& channel : out) {
      for (double& v : channel.pixels())
        v *= factor;
    }
    EXPECT_TRUE(scaled == out);
  }
}

TEST(ReturnedResidual, PixelsWithoutHalvesAndNotFiniteOnesKeepTheirValues) {
  const SamplePool pool = testing::make_pool(
      20, 20, 8, [](int x, int y, int s) { return noisy(x % 8 < 4 ? 0.2 : 2.0, x, y, s); });
  const auto counts = [](int x, int y) { return x < 5 ? (x + y) % 2 : 8; };
  RgbImage image = make_rgb(20, 20, 1.0);
  image[1](9, 9) = std::numeric_limits<double>::quiet_NaN();
  image[2](12, 9) = std::numeric_limits<double>::infinity();
  GuardCounts guards;
  const RgbImage out =
      return_residual(image, testing::select_counts(pool, counts), pool, 1.0, guards);
  EXPECT_EQ(guards[Guard::kResidualNotFinite], 2u);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) {
      if (x < 5) {
        EXPECT_EQ(out[0](x, y), 1.0);
      }
      if ((x == 9 || x == 12) && y == 9) continue;
      EXPECT_TRUE(std::isfinite(out[0](x, y) + out[1](x, y) + out[2](x, y)));
    }
  }
  EXPECT_EQ(out[0](9, 9), 1.0);
  EXPECT_TRUE(std::isnan(out[1](9, 9)));
  EXPECT_EQ(out[0](12, 9), 1.0);
  EXPECT_FALSE(out[0] == image[0]);
}

TEST(ReturnedResidualDeterminism, AnyNumberOfThreadsHasTheSameBits) {
  const SamplePool pool = testing::make_pool(
      70, 61, 8, [](int x, int y, int s) { return noisy(1.0 + (x % 3), x, y, s); });
  const Selection selection = testing::select_uniform(pool, 8);
  const RgbImage image = image_of_all_levels(70, 61);
  const auto run = [&](int threads) {
    return test::with_threads(threads, [&] { return returned(image, selection, pool, 1.0); });
  };
  const RgbImage one = run(1);
  for (const int threads : {2, 7})
    EXPECT_TRUE(run(threads) == one) << threads << " threads";
}

}  // namespace
}  // namespace spool
