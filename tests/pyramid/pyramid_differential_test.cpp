// The fast pyramid against its slow twins.
#include <gtest/gtest.h>

#include "lib/pyramid/convolution.h"
#include "lib/pyramid/laplacian_pyramid.h"
#include "lib/pyramid/region_mean.h"
#include "tests/pyramid/pyramid_cases.h"
#include "tests/reference/convolution_reference.h"
#include "tests/reference/laplacian_pyramid_reference.h"
#include "tests/reference/region_mean_reference.h"
#include "tests/reference/test_images.h"

namespace spool {
namespace {

using reference::firefly_image;
using reference::max_abs;
using reference::max_difference;

TEST(ConvolutionDifferential, EverySizeDilationAndBorderMatchesTheTwin) {
  const Taps tap_sets[] = {filter_pair(WaveletFilter::kHaar).analysis,
                           filter_pair(WaveletFilter::k53).analysis,
                           filter_pair(WaveletFilter::kDb3).analysis,
                           gaussian_taps(1.4),
                           Taps{2, {0.5, -1.0, 2.0}},
                           Taps{-3, {1.0}}};
  for (int width = 1; width <= 17; ++width) {
    for (int height = 1; height <= 17; height += (width % 3) + 1) {
      const Plane image = firefly_image(width, height, 21);
      for (const Taps& taps : tap_sets) {
        for (const int dilation : {1, 2, 8}) {
          for (const Extension extension : kExtensions) {
            EXPECT_LE(max_difference(convolve(image, taps, dilation, extension),
                                     reference::convolve(image, taps, dilation, extension)),
                      1e-14 * max_abs(image))
                << width << "x" << height << " D " << dilation;
          }
        }
      }
    }
  }
}

TEST(PyramidDifferential, EveryOptionMatchesTheTwin) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 7}, {16, 3}, {31, 17}}) {
    const Plane image = firefly_image(width, height, 22);
    for (const Extension extension : kExtensions) {
      for (const PyramidOptions& options : all_pyramid_options(extension)) {
        const Pyramid fast = build_pyramid(image, options);
        const Pyramid slow = reference::build_pyramid(image, options);
        for (std::size_t k = 0; k < fast.detail.size(); ++k) {
          ASSERT_LE(max_difference(fast.coarse[k + 1], slow.coarse[k + 1]), 1e-12 * max_abs(image))
              << describe(options);
          ASSERT_LE(max_difference(fast.detail[k], slow.detail[k]), 1e-12 * max_abs(image))
              << describe(options);
        }
      }
    }
  }
}

TEST(PyramidDifferential, EverySizeMatchesTheTwin) {
  for (int width = 1; width <= 64;
       width = width < 17 ? width + 1 : (width < 31 ? 31 : width + 33)) {
    for (int height : {1, 2, 5, 17, 64}) {
      const Plane image = firefly_image(width, height, 23);
      const PyramidOptions options;
      const Pyramid fast = build_pyramid(image, options);
      const Pyramid slow = reference::build_pyramid(image, options);
      for (std::size_t k = 0; k < 4; ++k) {
        ASSERT_LE(max_difference(fast.detail[k], slow.detail[k]), 1e-12 * max_abs(image));
      }
    }
  }
}

TEST(RegionMeanDifferential, EverySizeAndLevelMatchesTheTwin) {
  for (int width : {1, 2, 3, 7, 16, 17, 31, 64}) {
    for (int height : {1, 2, 5, 17, 33}) {
      const Plane image = firefly_image(width, height, 24);
      for (int level = 0; level <= 6; ++level) {
        EXPECT_LE(max_difference(region_mean(image, level), reference::region_mean(image, level)),
                  1e-14 * max_abs(image));
      }
    }
  }
}

}  // namespace
}  // namespace spool
