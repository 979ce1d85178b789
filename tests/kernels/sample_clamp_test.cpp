#include "lib/kernels/sample_clamp.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/kernels/scene_luminance.h"
#include "tests/reference/sample_clamp_reference.h"
#include "tests/reference/test_images.h"
#include "tests/support/memory_pool.h"
#include "tests/support/thread_count.h"

namespace spool {
namespace {

// Exponential radiance on a gradient, one sample in forty 500 times brighter.
Rgb heavy(int x, int y, int s) {
  double value = -std::log(1.0 - unit_double(mix(3, x, y, s))) * (0.2 + 0.05 * x + 0.02 * y);
  if (mix(5, x, y, s) % 40 == 0) value *= 500.0;
  return {static_cast<float>(value), static_cast<float>(0.7 * value),
          static_cast<float>(0.4 * value + 0.01)};
}

std::vector<FilmPosition> scattered(int count) {
  std::vector<FilmPosition> film;
  for (int s = 0; s < count; ++s) {
    film.push_back({s % 2 == 0 ? 0.2f : 0.7f, s / 2 % 2 == 0 ? 0.2f : 0.7f});
  }
  return film;
}

CountImage counts(const SamplePool& pool, int least, int most) {
  CountImage n(pool.width(), pool.height());
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x)
      n(x, y) =
          least + static_cast<int>(mix(9, x, y) % static_cast<std::uint64_t>(most - least + 1));
  }
  return n;
}

TEST(SampleClampDifferential, LimitsAgreeWithTheSlowTwin) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 7}, {9, 2}, {14, 11}}) {
    const SamplePool pool = test::memory_pool(width, height, 24, heavy);
    for (const int least : {1, 2, 3, 5, 20}) {
      const CountImage n = counts(pool, least, std::min(24, 2 * least + 3));
      GuardCounts guards;
      const double unit = scene_luminance(prefix_statistics(pool, n), guards);
      EXPECT_NEAR(unit, reference::mean_without_brightest(pool, n), 1e-12 * unit);
      for (const double sigma : {0.6, 2.0}) {
        const Plane fast = sample_limits(pool, n, unit, {.sigma = sigma});
        const Plane slow = reference::sample_limits(pool, n, 16.0, sigma, 0.005);
        EXPECT_LT(reference::max_difference(fast, slow), 1e-12 * reference::max_abs(slow))
            << width << " x " << height << ", from " << least << " samples, sigma " << sigma;
      }
    }
  }
}

TEST(SampleClampDifferential, QuarterPixelsCountAsOnePixel) {
  auto recording = std::make_shared<RecordedSamples>(*test::memory_recording(6, 5, 16, heavy));
  recording->set_pass_film(scattered(16));
  const SamplePool pool = test::pool_of(recording, {.pieces_per_side = 2});
  const CountImage n = counts(pool, 1, 4);
  GuardCounts guards;
  const double unit = scene_luminance(prefix_statistics(pool, n), guards);
  const Plane slow = reference::sample_limits(pool, n, 3.0, 2.0, 0.1);
  EXPECT_LT(
      reference::max_difference(sample_limits(pool, n, unit, {.kappa = 3.0, .floor = 0.1}), slow),
      1e-12 * reference::max_abs(slow));
}

TEST(SampleClamp, TakesOneFireflyAndLeavesARepeatedLight) {
  // A firefly in one sample of pixel (8, 8); a lamp that every sample of pixel (3, 3) sees.
  const SamplePool pool = test::memory_pool(16, 16, 8, [](int x, int y, int s) {
    const float noise = 0.5f + static_cast<float>(unit_double(mix(1, x, y, s)));
    if (x == 8 && y == 8 && s == 5) return Rgb{1e6f, 1e6f, 2e6f};
    if (x == 3 && y == 3) return Rgb{900.0f * noise, 900.0f * noise, 900.0f * noise};
    return Rgb{noise, noise, noise};
  });
  Selection selection{prefix_statistics(pool, CountImage(16, 16, 8)), {}};
  GuardCounts guards;
  const ClampedSamples clamped = clamp_samples(selection, pool, {}, guards);
  EXPECT_EQ(guards[Guard::kClampedSample], 1u);
  const Rgb firefly = clamped.pool.sample(8, 8, 5);
  EXPECT_LT(firefly[0], 60.0f);
  EXPECT_NEAR(firefly[2] / firefly[0], 2.0, 1e-6);  // its colour stays
  EXPECT_EQ(clamped.selection.statistics.mean[0](3, 3), selection.statistics.mean[0](3, 3));
  EXPECT_LT(clamped.selection.statistics.mean[0](8, 8), 10.0);
  EXPECT_EQ(clamped.pool.half(1).sample(8, 8, 2), firefly);  // halves are clamped too
}

TEST(SampleClamp, UnitDoesNotMatter) {
  const auto scaled = [](float unit) {
    return test::memory_pool(9, 9, 8, [=](int x, int y, int s) {
      Rgb value = heavy(x, y, s);
      for (float& v : value)
        v *= unit;
      return value;
    });
  };
  const CountImage n(9, 9, 6);
  const auto limits = [&](const SamplePool& pool) {
    GuardCounts guards;
    return sample_limits(pool, n, scene_luminance(prefix_statistics(pool, n), guards));
  };
  const Plane one = limits(scaled(1.0f));
  for (const float unit : {0x1p-20f, 0x1p20f}) {
    const Plane other = limits(scaled(unit));
    for (std::size_t i = 0; i < one.size(); ++i)
      EXPECT_DOUBLE_EQ(other[i], unit * one[i]);
  }
}

TEST(SampleClamp, NegativeAndBlackPixelsAreLeftAlone) {
  for (const float value : {0.0f, -2.0f}) {
    const SamplePool pool =
        test::memory_pool(5, 4, 4, [=](int, int, int) { return Rgb{value, value, value}; });
    const Selection selection{prefix_statistics(pool, CountImage(5, 4, 4)), {}};
    GuardCounts guards;
    const ClampedSamples clamped = clamp_samples(selection, pool, {}, guards);
    EXPECT_EQ(guards[Guard::kClampedSample], 0u);
    EXPECT_TRUE(clamped.selection.statistics == selection.statistics);
  }
}

TEST(SampleClamp, PixelsWithoutSamplesTakePartWithTheirNeighbours) {
  const SamplePool pool =
      test::memory_pool(7, 7, 4, [](int, int, int) { return Rgb{1.0f, 1.0f, 1.0f}; });
  CountImage n(7, 7, 4);
  n(3, 3) = 0;
  const Plane limits = sample_limits(pool, n, 1.0);
  for (const double limit : limits.pixels())
    EXPECT_NEAR(limit, 16.005, 1e-12);
}

TEST(SampleClamp, LowerOfTwoLimitsHolds) {
  const SamplePool pool =
      test::memory_pool(2, 1, 1, [](int, int, int) { return Rgb{8.0f, 8.0f, 8.0f}; });
  const SamplePool twice = pool.with_limits(Plane(2, 1, 4.0)).with_limits(Plane(2, 1, 6.0));
  EXPECT_FLOAT_EQ(twice.sample(1, 0, 0)[1], 4.0f);
}

TEST(SampleClampDeterminism, SameBitsForAnyNumberOfThreads) {
  const SamplePool pool = test::memory_pool(70, 41, 8, heavy);
  const Selection selection{prefix_statistics(pool, counts(pool, 2, 8)), {}};
  const auto run = [&](int threads) {
    return test::with_threads(threads, [&] {
      GuardCounts guards;
      return clamp_samples(selection, pool, {}, guards).selection.statistics;
    });
  };
  const PieceStatistics one = run(1);
  for (const int threads : {2, 3, 8})
    EXPECT_TRUE(run(threads) == one) << threads << " threads";
}

}  // namespace
}  // namespace spool
