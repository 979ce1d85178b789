#include <gtest/gtest.h>

#include "lib/core/parallel.h"
#include "lib/directions/directional_energy.h"
#include "tests/reference/test_images.h"

namespace spool {
namespace {

template <class T>
void expect_same_bits_for_any_threads() {
  const Plane noise = reference::firefly_image(190, 143, 81);
  Image<T> image(190, 143);
  for (std::size_t i = 0; i < image.size(); ++i)
    image[i] = static_cast<T>(noise[i]);
  std::vector<Image<T>> expected_bands, expected_energy;
  GuardCounts expected_guards;
  for (const int threads : {1, 2, 3, 8}) {
    const ThreadLimit limit(threads);
    BankOptions bank;
    bank.dilation = 2;
    const NoisyBands<T> noisy = {directional_bands(image, bank), std::vector<double>(8, 1e6)};
    GuardCounts guards;
    const auto result =
        directional_energy<T>(noisy, Plane(190, 143, 1.0), 3, EnergyOptions{}, guards);
    if (threads == 1) {
      expected_bands = noisy.bands;
      expected_energy = result.energy;
      expected_guards = guards;
    }
    EXPECT_EQ(noisy.bands, expected_bands) << threads;
    EXPECT_EQ(result.energy, expected_energy) << threads;
    EXPECT_EQ(guards, expected_guards) << threads;
  }
}

TEST(DirectionsDeterminism, BitsDoNotDependOnThreads) {
  expect_same_bits_for_any_threads<double>();
  expect_same_bits_for_any_threads<float>();
}

}  // namespace
}  // namespace spool
