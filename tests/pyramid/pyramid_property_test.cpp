#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "lib/pyramid/convolution.h"
#include "lib/pyramid/laplacian_pyramid.h"
#include "lib/pyramid/region_mean.h"
#include "tests/pyramid/pyramid_cases.h"
#include "tests/reference/test_images.h"

namespace spool {
namespace {

Rectangle any_box(int width, int height) {
  const int x0 = *rc::gen::inRange(0, width), y0 = *rc::gen::inRange(0, height);
  return {x0, y0, *rc::gen::inRange(x0 + 1, width + 1), *rc::gen::inRange(y0 + 1, height + 1)};
}

RC_GTEST_PROP(PyramidProperty, LocalUpdateHasTheBitsOfAFullRebuild, ()) {
  const int width = *rc::gen::inRange(1, 70), height = *rc::gen::inRange(1, 70);
  const auto cases = all_pyramid_options(*rc::gen::elementOf(std::vector<Extension>{
      Extension::kSymmetric, Extension::kClamp, Extension::kPeriodic, Extension::kWhole}));
  const PyramidOptions options = *rc::gen::elementOf(cases);
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const Rectangle box = any_box(width, height);
  Pyramid local = build_pyramid(reference::firefly_image(width, height, seed), options);
  for (int y = box.y0; y < box.y1; ++y) {
    for (int x = box.x0; x < box.x1; ++x)
      local.coarse[0](x, y) += 1.0 + unit_double(mix(seed, y, x));
  }
  update_pyramid(local, box, options);
  const Pyramid full = build_pyramid(local.coarse[0], options);
  RC_ASSERT(local.coarse == full.coarse);
  RC_ASSERT(local.detail == full.detail);
}

RC_GTEST_PROP(ConvolutionProperty, RectangleHasTheBitsOfTheWhole, ()) {
  const int width = *rc::gen::inRange(1, 60), height = *rc::gen::inRange(1, 60);
  const Plane image = reference::firefly_image(width, height, *rc::gen::arbitrary<std::uint64_t>());
  const Taps taps = gaussian_taps(*rc::gen::elementOf(std::vector<double>{0.2, 0.5, 1.3, 2.8}));
  const int dilation = *rc::gen::inRange(1, 9);
  const auto extension = *rc::gen::elementOf(std::vector<Extension>{
      Extension::kSymmetric, Extension::kClamp, Extension::kPeriodic, Extension::kWhole});
  const Rectangle box = any_box(width, height);
  const Plane whole = convolve(image, taps, dilation, extension);
  Plane part(width, height, -1.0);
  convolve_box(image, taps, dilation, extension, box, part);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      RC_ASSERT(part(x, y) == (box.contains(x, y) ? whole(x, y) : -1.0));
    }
  }
}

RC_GTEST_PROP(RegionMeanProperty, RectangleHasTheBitsOfTheWhole, ()) {
  const int width = *rc::gen::inRange(1, 60), height = *rc::gen::inRange(1, 60);
  const Plane image = reference::firefly_image(width, height, *rc::gen::arbitrary<std::uint64_t>());
  const int level = *rc::gen::inRange(0, 7);
  const Rectangle box = any_box(width, height);
  const Plane whole = region_mean(image, level);
  Plane part(width, height, -1.0);
  region_mean_box(image, level, box, part);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      RC_ASSERT(part(x, y) == (box.contains(x, y) ? whole(x, y) : -1.0));
    }
  }
}

}  // namespace
}  // namespace spool
