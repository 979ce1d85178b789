#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "lib/directions/directional_filter_bank.h"
#include "tests/reference/test_images.h"

namespace spool {
namespace {

using reference::firefly_image;
using reference::max_abs;
using reference::max_difference;

BankOptions any_bank() {
  BankOptions options;
  options.levels = *rc::gen::inRange(1, 4);
  options.dilation = *rc::gen::inRange(1, 9);
  options.taps = *rc::gen::element(SignTaps::kPkva6, SignTaps::kPkva8, SignTaps::kPkva12);
  return options;
}

RC_GTEST_PROP(DirectionalFilterBankProperty, BandsSumToTheImageAndMirrorWithIt, ()) {
  const int width = *rc::gen::inRange(1, 50), height = *rc::gen::inRange(1, 50);
  const Plane image = firefly_image(width, height, *rc::gen::arbitrary<std::uint64_t>());
  const BankOptions options = any_bank();
  const auto bands = directional_bands(image, options);
  const auto of_mirrored = directional_bands(reference::mirrored_x(image), options);
  Plane sum(width, height);
  for (std::size_t i = 0; i < bands.size(); ++i) {
    for (std::size_t p = 0; p < sum.size(); ++p)
      sum[p] += bands[i][p];
    const std::size_t j = options.levels == 1 ? i : bands.size() - 1 - i;
    RC_ASSERT(max_difference(of_mirrored[i], reference::mirrored_x(bands[j])) <=
              1e-14 * max_abs(image));
  }
  RC_ASSERT(max_difference(sum, image) <= 4e-15 * max_abs(image));
}

RC_GTEST_PROP(DirectionalFilterBankProperty, BandsAreLinear, ()) {
  const int width = *rc::gen::inRange(1, 40), height = *rc::gen::inRange(1, 40);
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const Plane a = firefly_image(width, height, seed), b = firefly_image(width, height, seed + 1);
  Plane mixed(width, height);
  for (std::size_t i = 0; i < mixed.size(); ++i)
    mixed[i] = 2.0 * a[i] - 3.0 * b[i];
  const BankOptions options = any_bank();
  const auto of_a = directional_bands(a, options), of_b = directional_bands(b, options);
  const auto of_mixed = directional_bands(mixed, options);
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    for (std::size_t p = 0; p < mixed.size(); ++p) {
      RC_ASSERT(std::abs(of_mixed[i][p] - (2.0 * of_a[i][p] - 3.0 * of_b[i][p])) <=
                1e-13 * (max_abs(a) + max_abs(b)));
    }
  }
}

}  // namespace
}  // namespace spool
