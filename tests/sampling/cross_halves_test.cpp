// No half of the samples decides about itself, and what that is worth.
#include "lib/sampling/cross_halves.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "lib/sampling/filtered_halves.h"
#include "lib/sampling/rounds.h"
#include "lib/statistics/joined_halves.h"
#include "tests/reference/cross_halves_reference.h"
#include "tests/sampling/multiscale_cases.h"
#include "tests/support/every_method.h"
#include "tests/support/sizes.h"

namespace spool {
namespace {

TEST(CrossHalves, CountsEqualThoseOfTheSlowTwin) {
  const SamplingContext context = test::sampling_context();
  for (const auto& [width, height] : test::twin_sizes()) {
    SCOPED_TRACE(fmt::format("{} x {}", width, height));
    const SamplePool pool = test::noisy_pool(width, height, 24);
    const long long pieces = width * height;
    for (const int rounds : {1, 3}) {
      for (const long long budget :
           {3 * pieces, 4 * pieces, 5 * pieces + 2, 7 * pieces + 3, 12 * pieces, 23 * pieces + 1}) {
        CrossHalvesOptions options;
        options.rounds = rounds;
        const auto result = sample_cross_halves(pool, budget, options, context);
        ASSERT_TRUE(result.has_value());
        std::array<CountImage, 2> first;
        std::array<double, 2> exposure;
        std::array<long long, 2> left;
        const bool alone = budget >= 4 * pieces && budget / 2 < 3 * pieces;  // the even one decides
        for (std::size_t h = 0; h < 2; ++h) {
          const SamplePool half = pool.half(static_cast<int>(h));
          const long long share = (budget + 1 - static_cast<long long>(h)) / 2;
          const long long least = !alone ? 2 * pieces : h == 0 ? share : pieces;
          const long long start =
              std::min(share, std::max(std::llround(0.5 * static_cast<double>(share)), least));
          first[h] = initial_counts(half, start, std::numeric_limits<int>::max(),
                                    mix(context.seed, static_cast<std::uint64_t>(h)));
          GuardCounts guards;
          exposure[h] = exposure_of(prefix_statistics(half, first[h]), guards);
          left[h] = std::min(share, half.total_capacity()) - start;
        }
        const auto expected = reference::cross_halves(
            pool, first, exposure, left, alone ? 1 : rounds, options.blur, context.filter);
        for (std::size_t h = 0; h < 2; ++h)
          EXPECT_EQ(result->selection.halves[h].statistics.n, expected[h])
              << rounds << " " << budget;
      }
    }
  }
}

// Another half B beside the same half A.
TEST(CrossHalves, NoSampleOfAHalfChangesItsOwnCountInOneRound) {
  const auto pool_with = [](bool other_odd) {
    return test::pool_of(test::memory_recording(24, 20, 32, [=](int x, int y, int s) {
      const auto v = static_cast<float>(unit_double(mix(1, x, y, s)));
      const float value = s % 2 == 1 && other_odd && x > 9 ? 9.0f * v * v * v : v;
      return Rgb{value, value, value};
    }));
  };
  CrossHalvesOptions options;
  options.rounds = 1;
  const SamplingContext context = test::sampling_context();
  const auto a = sample_cross_halves(pool_with(false), 24 * 20 * 8, options, context);
  const auto b = sample_cross_halves(pool_with(true), 24 * 20 * 8, options, context);
  const auto counts = [](const auto& result, std::size_t h) {
    return result->selection.halves[h].statistics.n;
  };
  EXPECT_EQ(counts(a, 1), counts(b, 1));
  EXPECT_NE(counts(a, 0), counts(b, 0));
  EXPECT_NE(a->selection.halves[1].statistics.mean, b->selection.halves[1].statistics.mean);
}

double mean_of(const RgbImage& image) {
  double sum = 0.0;
  for (const double v : image[1].pixels())
    sum += v;
  return sum / static_cast<double>(image[1].size());
}

// Rare bright events: 20 with probability 0.05, mean 1, everywhere alike.
TEST(CrossHalves, LosesNoLightWhereHalvesThatDecideAboutThemselvesDo) {
  constexpr int kSide = 48, kRuns = 8;
  const SamplingContext context = test::sampling_context();
  CrossHalvesOptions options;
  FilteredHalvesOptions options_of_own;
  options.blur = options_of_own.blur = 1.0;
  double crossed = 0.0, at_four = 0.0, in_rounds = 0.0, own = 0.0, square = 0.0;
  for (int r = 0; r < kRuns; ++r) {
    const SamplePool pool =
        test::pool_of(test::memory_recording(kSide, kSide, 96, [=](int x, int y, int s) {
          const float value = unit_double(mix(40 + r, x, y, s)) < 0.05 ? 20.0f : 0.0f;
          return Rgb{value, value, value};
        }));
    const auto cross = sample_cross_halves(pool, kSide * kSide * 8, options, context);
    at_four += mean_of(sample_cross_halves(pool, kSide * kSide * 4, options, context)
                           ->selection.statistics.mean) /
               kRuns;
    options.rounds = 3;
    in_rounds += mean_of(sample_cross_halves(pool, kSide * kSide * 8, options, context)
                             ->selection.statistics.mean) /
                 kRuns;
    options.rounds = 1;
    const auto halves = sample_filtered_halves(pool, kSide * kSide * 8, options_of_own, context);
    ASSERT_TRUE(cross.has_value() && halves.has_value());
    const RgbImage& mean = cross->selection.statistics.mean;
    crossed += mean_of(mean) / kRuns;
    own += mean_of(halves->selection.statistics.mean) / kRuns;
    for (const double v : mean[1].pixels())
      square += (v - 1.0) * (v - 1.0);
  }
  const double pixels = kRuns * kSide * kSide;
  const double standard_error = std::sqrt(square / pixels / pixels);
  EXPECT_NEAR(crossed, 1.0, 4.0 * standard_error);
  EXPECT_NEAR(at_four, 1.0, 6.0 * standard_error);  // of half the samples
  EXPECT_LT(standard_error, 0.015);
  EXPECT_LT(own, 0.93);
  EXPECT_LT(in_rounds, 0.93);  // what several rounds give away
}

// 24 x 24 pixels, 64 samples: 1 on the left, of mean 1 with noise on the right.
SamplePool noisy_right_half() {
  return test::pool_of(test::memory_recording(24, 24, 64, [](int x, int y, int s) {
    const auto noise = static_cast<float>(unit_double(mix(2, x, y, s)));
    const float value = x < 12 ? 1.0f : 2.0f * noise;
    return Rgb{value, value, value};
  }));
}

TEST(CrossHalves, AtFourSamplesTheEvenHalfDecidesWhereTheOddOneSamples) {
  const SamplePool pool = noisy_right_half();
  const auto result = sample_cross_halves(pool, 24 * 24 * 4, {}, test::sampling_context());
  const CountImage &even = result->selection.halves[0].statistics.n,
                   &odd = result->selection.halves[1].statistics.n;
  long long quiet = 0, noisy = 0;
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x) {
      EXPECT_EQ(even(x, y), 2);
      EXPECT_GE(odd(x, y), 1);
      (x < 12 ? quiet : noisy) += odd(x, y);
    }
  }
  EXPECT_GT(noisy, 2 * quiet);
  EXPECT_EQ(quiet + noisy, 24 * 24 * 2);
}

TEST(CrossHalves, LooksMoreOftenWhereItIsNoisy) {
  const SamplePool pool = noisy_right_half();
  const auto result = sample_cross_halves(pool, 24 * 24 * 12, {}, test::sampling_context());
  long long quiet = 0, noisy = 0;
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x)
      (x < 12 ? quiet : noisy) += result->selection.statistics.n(x, y);
  }
  EXPECT_GT(noisy, 3 * quiet / 2);
  EXPECT_EQ(quiet + noisy, 24 * 24 * 12);
  EXPECT_EQ(sample_cross_halves(pool, 100, {}, {}).error().code, ErrorCode::kUsage);
}

}  // namespace
}  // namespace spool
