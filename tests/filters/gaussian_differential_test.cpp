#include <gtest/gtest.h>

#include "lib/filters/box.h"
#include "lib/filters/gaussian.h"
#include "tests/filters/small_pools.h"
#include "tests/reference/gaussian_reference.h"
#include "tests/reference/test_images.h"

namespace spool {
namespace {

TEST(GaussianDifferential, ImageAndVarianceAgreeWithTheDoubleSum) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {9, 1}, {7, 5}, {16, 17}}) {
    const SamplePool pool =
        testing::make_pool(width, height, 4, testing::noisy_picture(width, height, 11));
    const Selection selection = testing::select_uniform(pool, 4);
    const auto box = reconstruct_box(selection, pool, {}, {});
    for (const double sigma : {0.0, 0.5, 1.0, 2.7}) {
      const auto result = reconstruct_gaussian(selection, pool, {.sigma = sigma}, {});
      ASSERT_TRUE(result.has_value());
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_LT(reference::max_difference(result->image[c],
                                            reference::gaussian_sum(box->image[c], sigma, 1)),
                  1e-14);
        EXPECT_LT(reference::max_difference((*result->variance)[c],
                                            reference::gaussian_sum((*box->variance)[c], sigma, 2)),
                  1e-15);
      }
    }
  }
}

}  // namespace
}  // namespace spool
