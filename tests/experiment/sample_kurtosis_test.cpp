#include "lib/experiment/sample_kurtosis.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "lib/core/random.h"

namespace spool {
namespace {

// Samples [pixel][s] of one gray value, the same in the three channels.
template <class Value>
RecordedSamples recording(int side, int spp, Value&& value) {
  const auto n = static_cast<std::size_t>(side) * static_cast<std::size_t>(side) *
                 static_cast<std::size_t>(spp);
  std::vector<float> radiance(3 * n);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < n; ++i)
      radiance[c * n + i] = static_cast<float>(value(i / static_cast<std::size_t>(spp), i));
  }
  return *RecordedSamples::from_memory("samples", side, side, spp, std::move(radiance));
}

double uniform(std::uint64_t i) {
  return unit_double(mix(5, i));
}

double normal(std::uint64_t i) {
  return std::sqrt(-2.0 * std::log(1.0 - uniform(i))) *
         std::cos(2.0 * std::numbers::pi * unit_double(mix(6, i)));
}

// Pixels differ in mean and variance, which must not look like a tail. Standard deviation of the
// estimate over seeds, 1024 pixels of 16 samples: 0.05 (uniform), 0.08 (normal), 0.9 (exponential).
TEST(SampleKurtosis, IsThatOfTheDistributionWhateverThePixelsAre) {
  const auto of = [](auto&& noise) {
    return sample_kurtosis(recording(32, 16, [&](std::size_t pixel, std::size_t i) {
      const double mean = 1.0 + static_cast<double>(pixel % 7);
      return mean * (8.0 + noise(i));
    }));
  };
  EXPECT_NEAR(of(uniform), -1.2, 0.2);
  EXPECT_NEAR(of(normal), 0.0, 0.3);
  EXPECT_NEAR(of([](std::size_t i) { return -std::log(1.0 - uniform(i)); }), 6.0, 3.0);
}

// The square of a variance of few samples is too large by a third: that is taken off. Standard
// deviation of the estimate over seeds: 0.03.
TEST(SampleKurtosis, SixSamplesOfAPixelAreEnough) {
  EXPECT_NEAR(sample_kurtosis(
                  recording(64, 6, [](std::size_t, std::size_t i) { return 8.0 + uniform(i); })),
              -1.2, 0.1);
}

TEST(SampleKurtosis, OfOneFireflyIsLarge) {
  EXPECT_GT(sample_kurtosis(recording(32, 16,
                                      [](std::size_t, std::size_t i) {
                                        return i == 777 ? 1000.0 : 1.0 + 0.1 * uniform(i);
                                      })),
            10.0);
}

TEST(SampleKurtosis, IsTheSameInAnyUnit) {
  const auto scaled = [](float unit) {
    return sample_kurtosis(recording(16, 16, [=](std::size_t pixel, std::size_t i) {
      return unit * static_cast<float>(1.0 + static_cast<double>(pixel % 3) + uniform(i));
    }));
  };
  EXPECT_DOUBLE_EQ(scaled(1.0f), scaled(0x1p-30f));
  EXPECT_DOUBLE_EQ(scaled(1.0f), scaled(0x1p40f));
}

TEST(SampleKurtosis, IsNotKnownOfConstantsAndOfThreeSamples) {
  EXPECT_TRUE(
      std::isnan(sample_kurtosis(recording(4, 16, [](std::size_t, std::size_t) { return 0.5; }))));
  EXPECT_TRUE(std::isnan(
      sample_kurtosis(recording(4, 3, [](std::size_t, std::size_t i) { return uniform(i); }))));
}

}  // namespace
}  // namespace spool
