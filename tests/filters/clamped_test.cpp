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
