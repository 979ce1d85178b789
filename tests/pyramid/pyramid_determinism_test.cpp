#include <gtest/gtest.h>

#include "lib/core/parallel.h"

#include "lib/pyramid/laplacian_pyramid.h"
#include "lib/pyramid/region_mean.h"
#include "tests/reference/test_images.h"

namespace spool {
namespace {

TEST(PyramidDeterminism, BitsDoNotDependOnThreads) {
  const Plane image = reference::firefly_image(211, 173, 31);
  PyramidOptions options;
  options.filter = WaveletFilter::kDb3;
  Pyramid expected;
  Plane expected_mean;
  for (const int threads : {1, 2, 3, 8}) {
    const ThreadLimit limit(threads);
    const Pyramid pyramid = build_pyramid(image, options);
    const Plane mean = region_mean(image, 4);
    if (threads == 1) {
      expected = pyramid;
      expected_mean = mean;
    }
    EXPECT_EQ(pyramid.coarse, expected.coarse) << threads;
    EXPECT_EQ(pyramid.detail, expected.detail) << threads;
    EXPECT_EQ(mean, expected_mean) << threads;
  }
}

}  // namespace
}  // namespace spool
