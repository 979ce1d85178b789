#include "lib/filters/clamped.h"

#include <gtest/gtest.h>

#include "tests/filters/small_pools.h"
#include "tests/reference/clamped_reference.h"
#include "tests/reference/test_images.h"
#include "tests/support/thread_count.h"

namespace spool {
namespace {

testing::RadianceFunction heavy(int width, int height) {
  return [=](int x, int y, int s) {
    Rgb value = testing::noisy_picture(width, height, 4)(x, y, s);
    if (mix(8, x, y, s) % 30 == 0) {
      for (float& v : value)
        v *= 100.0f;
    }
    return value;
  };
}

TEST(ClampedDifferential, AgreesWithTheSlowTwin) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 6}, {7, 1}, {13, 9}}) {
    const SamplePool pool = testing::make_pool(width, height, 9, heavy(width, height));
    const Selection selection =
        testing::select_counts(pool, [](int x, int y) { return 1 + (3 * x + 5 * y) % 9; });
    for (const double factor : {0.0, 1.0, 4.0}) {
      const auto result = reconstruct_clamped(selection, pool, {factor}, {});
      const RgbImage slow = reference::clamped(pool, selection.statistics.n, factor);
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_LT(reference::max_difference(result->image[c], slow[c]), 1e-12);
    }
  }
}

TEST(Clamped, ChangesTheBrightestSampleOnly) {
  const SamplePool pool = testing::make_pool(3, 3, 4, [](int x, int y, int s) {
    const bool centre = x == 1 && y == 1;
    const float v = centre && s < 2 ? 100.0f * static_cast<float>(s + 1) : 1.0f;
    return Rgb{v, v, v};
  });
  const Selection selection = testing::select_uniform(pool, 4);
  const auto result = reconstruct_clamped(selection, pool, {}, {});
  // 100, 200, 1, 1 with 200 limited to 4 times the neighbours' 1.
  EXPECT_NEAR(result->image[1](1, 1), (100.0 + 4.0 + 1.0 + 1.0) / 4.0, 1e-12);
  EXPECT_EQ(result->guards[Guard::kClampedSample], 1u);
  EXPECT_EQ(result->image[1](0, 0), 1.0);
}

TEST(Clamped, ASampleOfJoinedHalvesCountsAsItDoesInTheirMean) {
  const SamplePool pool = testing::make_pool(13, 9, 9, heavy(13, 9));
  const Selection selection = testing::joined_halves(pool);
  const SamplePool first = pool_of_joined(pool, selection);
  const auto none = reconstruct_clamped(selection, first, {0.0}, {});
  // Without its brightest sample; black where a half has no other.
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 13; ++x) {
      const int n[2] = {selection.halves[0].statistics.n(x, y),
                        selection.halves[1].statistics.n(x, y)};
      int at_half = 0, at = 0;
      double brightest = -1.0, expected = 0.0;
      for (int h = 0; h < 2; ++h) {
        for (int i = 0; i < n[h]; ++i) {
          const Rgb v = pool.half(h).sample(x, y, i);
          if (const double l = luminance(v[0], v[1], v[2]); l > brightest)
            brightest = l, at_half = h, at = i;
        }
      }
      for (int h = 0; h < 2; ++h)
        for (int i = 0; i < n[h]; ++i)
          if (h != at_half || i != at) expected += 0.5 * pool.half(h).sample(x, y, i)[1] / n[h];
      EXPECT_NEAR(none->image[1](x, y), expected, 1e-12 * std::max(1.0, brightest));
    }
  }
}

TEST(ClampedDeterminism, SameBitsForAnyNumberOfThreads) {
  const SamplePool pool = testing::make_pool(61, 40, 6, heavy(61, 40));
  const Selection selection = testing::select_uniform(pool, 6);
  const auto run = [&](int threads) {
    return test::with_threads(threads,
                              [&] { return reconstruct_clamped(selection, pool, {}, {})->image; });
  };
  const RgbImage one = run(1);
  for (const int threads : {2, 3, 8})
    EXPECT_TRUE(run(threads) == one) << threads << " threads";
}

}  // namespace
}  // namespace spool
