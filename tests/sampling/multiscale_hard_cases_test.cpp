// Odd sizes and odd pools. Every case must spend what can be spent and leave finite numbers.
#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "lib/sampling/multiscale/analysis.h"
#include "lib/sampling/multiscale/block_analysis.h"
#include "lib/sampling/multiscale/board.h"
#include "lib/sampling/multiscale/priority.h"
#include "lib/sampling/sampler.h"
#include "tests/sampling/multiscale_cases.h"

namespace spool {
namespace {

using Radiance = std::function<Rgb(int, int, int)>;

void expect_sound(const SamplePool& pool, long long budget, const std::string& preset,
                  const OptionValues& set) {
  const SamplingResult result =
      test::run_multiscale(pool, budget, test::multiscale_options(preset, set));
  EXPECT_EQ(test::total(result.selection.statistics.n), std::min(budget, pool.total_capacity()));
  EXPECT_EQ(result.log.guards[Guard::kPriorityNotFinite], 0u);
  for (const Plane& a : result.selection.attenuation) {
    for (const double value : a.pixels())
      ASSERT_TRUE(std::isfinite(value));
  }
}

void expect_sound_everywhere(const SamplePool& pool, long long budget) {
  expect_sound(pool, budget, "robust", {});
  expect_sound(pool, budget, "robust", {{"update", "exact"}});
  expect_sound(pool, budget, "robust", {{"tile", "16"}});
}

// No sample in float makes a priority overflow, so the analysis is broken by hand.
TEST(MultiscaleHardCases, PrioritiesThatAreNotFiniteAreTheLargestAndCounted) {
  const SamplePool pool = test::noisy_pool(8, 6, 8);
  for (const char* norm : {"absolute", "relative", "off"}) {
    const MultiscaleOptions options = test::multiscale_options("robust", {{"d_norm", norm}});
    const CountImage counts(8, 6, 4);
    const Samples samples = make_samples(prefix_statistics(pool, counts), pool, 1.0, options);
    GuardCounts loading;
    ExactBoard board =
        load_board<double>(samples, pool, {0, 0, 8, 6}, {0, 0, 8, 6}, options, loading);
    analyse(board, options, false, loading);
    EXPECT_EQ(loading[Guard::kPriorityNotFinite], 0u);
    board.scalars[0].variance[0](2, 3) = std::numeric_limits<double>::infinity();
    board.scalars[0].variance[0](4, 1) = std::numeric_limits<double>::quiet_NaN();
    GuardCounts guards;
    compute_priority(board, 1, board.bounds(), options, guards);
    EXPECT_EQ(guards[Guard::kPriorityNotFinite], 2u) << norm;
    EXPECT_EQ(board.priority[0](2, 3), std::numeric_limits<double>::max()) << norm;
    EXPECT_EQ(board.priority[0](4, 1), std::numeric_limits<double>::max()) << norm;
    EXPECT_LT(board.priority[0](3, 3), 1e6) << norm;
  }
}

TEST(MultiscaleHardCases, PrioritiesInFloatThatAreNotFiniteAreTheLargestAndCounted) {
  const SamplePool pool = test::noisy_pool(8, 6, 8);
  for (const char* norm : {"absolute", "relative", "off"}) {
    const MultiscaleOptions options = test::multiscale_options("robust", {{"d_norm", norm}});
    const Samples samples =
        make_samples(prefix_statistics(pool, CountImage(8, 6, 4)), pool, 1.0, options);
    GuardCounts loading;
    EpochBoard board =
        load_board<float>(samples, pool, {0, 0, 8, 6}, {0, 0, 8, 6}, options, loading);
    analyse(board, options, false, loading);
    EXPECT_EQ(loading[Guard::kPriorityNotFinite], 0u);
    board.scalars[0].attenuation[1](2, 3) = std::numeric_limits<float>::infinity();
    board.scalars[0].attenuation[1](4, 1) = std::numeric_limits<float>::quiet_NaN();
    GuardCounts guards;
    BlockAnalysis(board, options).update(board.bounds(), guards);
    EXPECT_EQ(guards[Guard::kPriorityNotFinite], 2u) << norm;
    EXPECT_EQ(board.priority[0](2, 3), std::numeric_limits<float>::max()) << norm;
    EXPECT_EQ(board.priority[0](4, 1), std::numeric_limits<float>::max()) << norm;
    EXPECT_LT(board.priority[0](3, 3), 1e6f) << norm;
  }
}

// Values whose squares float cannot hold are limited when a board is loaded.
TEST(MultiscaleHardCases, ASampleNearTheLargestFloatLeavesTheAnalysisFinite) {
  const SamplePool pool = test::memory_pool(40, 40, 16, [](int x, int y, int s) {
    const float v = x == 20 && y == 11 && s == 1 ? 3e38f : 0.5f + 0.1f * static_cast<float>(s % 3);
    return Rgb{v, v, v};
  });
  expect_sound_everywhere(pool, 40 * 40 * 6);
}

TEST(MultiscaleHardCases, OddSizes) {
  const int sizes[][2] = {{1, 1}, {1, 9}, {9, 1}, {97, 61}, {17, 16}, {2, 3}};
  for (const auto& [width, height] : sizes) {
    const SamplePool pool = test::noisy_pool(width, height, 8);
    const long long pieces = width * height;
    expect_sound_everywhere(pool, 4 * pieces + 1);
    expect_sound(pool, 3 * pieces, "paper", {{"tile", "16"}});
  }
}

TEST(MultiscaleHardCases, OneSamplePerPixelOrFewer) {
  const SamplePool pool = test::noisy_pool(20, 20, 8);
  for (const long long budget : {0, 1, 200, 400, 401, 799})
    expect_sound_everywhere(pool, budget);
}

TEST(MultiscaleHardCases, PoolSmallerThanTheBudget) {
  expect_sound_everywhere(test::noisy_pool(20, 18, 3), 20 * 18 * 8);
  expect_sound_everywhere(test::noisy_pool(20, 18, 1), 20 * 18 * 8);
}

TEST(MultiscaleHardCases, BlackAndConstantImagesAreSampledUniformly) {
  for (const float value : {0.0f, 0.25f, -1.0f}) {
    const SamplePool pool =
        test::memory_pool(30, 21, 8, [&](int, int, int) { return Rgb{value, value, value}; });
    for (const char* mode : {"epoch", "exact"}) {
      // Haar of a constant is a constant exactly; 5-3 leaves rounding.
      const SamplingResult result = test::run_multiscale(
          pool, 30 * 21 * 5,
          test::multiscale_options("robust", {{"update", mode}, {"filter", "haar"}}));
      for (const auto n : result.selection.statistics.n.pixels())
        ASSERT_EQ(n, 5) << value << " " << mode;
      EXPECT_EQ(result.log.uniform_remainder, 30 * 21 * 3);
      EXPECT_EQ(result.log.guards[Guard::kUniformRemainder], 30u * 21u * 3u);
    }
    expect_sound_everywhere(pool, 30 * 21 * 5 + 7);
  }
  const SamplePool black = test::memory_pool(30, 21, 8, [](int, int, int) { return Rgb{0, 0, 0}; });
  const SamplingResult result =
      test::run_multiscale(black, 30 * 21 * 5, test::multiscale_options("robust", {}));
  EXPECT_EQ(result.log.uniform_remainder, 30 * 21 * 3);
}

TEST(MultiscaleHardCases, OneHugeFirefly) {
  const SamplePool pool = test::memory_pool(40, 40, 16, [](int x, int y, int s) {
    const float v = x == 20 && y == 11 && s == 1 ? 1e6f : 0.5f;
    return Rgb{v, v, v};
  });
  expect_sound_everywhere(pool, 40 * 40 * 6);
}

TEST(MultiscaleHardCases, NegativeNoiseAndRejectedSamples) {
  expect_sound_everywhere(
      test::memory_pool(24, 24, 10,
                        [](int x, int y, int s) {
                          const auto u = static_cast<float>(unit_double(mix(2, x, y, s)) - 0.7);
                          return Rgb{u, u, u};
                        }),
      24 * 24 * 5);
  SanitiseRules rules;
  rules.allow_many_rejected = true;
  const SamplePool pool = test::memory_pool(
      24, 24, 10,
      [](int x, int y, int s) {
        const auto u = static_cast<float>(unit_double(mix(2, x, y, s)));
        const bool bad = mix(9, x, y, s) % 20 == 0 || (x == 3 && y == 4);
        const float v = bad ? std::numeric_limits<float>::infinity() : u;
        return Rgb{v, v, v};
      },
      rules);
  EXPECT_EQ(pool.capacity(3, 4), 0);  // a pixel that kept nothing
  expect_sound_everywhere(pool, 24 * 24 * 5);
  expect_sound_everywhere(pool, 24 * 24 * 10);
}

TEST(MultiscaleHardCases, LiteralContrastOfMixedSignIsCountedNotFatal) {
  const SamplePool pool = test::memory_pool(16, 16, 8, [](int x, int y, int s) {
    const float v = (x + y) % 2 == 0 ? (s % 2 == 0 ? 1.0f : -1.0f) : 0.0f;
    return Rgb{v, v, v};
  });
  const SamplingResult result = test::run_multiscale(
      pool, 16 * 16 * 4, test::multiscale_options("paper", {{"tile", "0"}, {"init_spp", "2"}}));
  EXPECT_EQ(test::total(result.selection.statistics.n), 16 * 16 * 4);
  EXPECT_GT(result.log.guards[Guard::kContrastUndefined], 0u);
}

TEST(MultiscaleHardCases, HeldOutSamplesAreNeverTaken) {
  const auto recording = test::memory_recording(
      20, 20, 16, [](int x, int y, int s) { return test::varied_noise(20, x, y, s); });
  PoolOptions options;
  options.holdout = 10;
  const SamplePool pool = test::pool_of(recording, options);
  const SamplingResult result =
      test::run_multiscale(pool, 20 * 20 * 12, test::multiscale_options("robust", {}));
  for (const auto n : result.selection.statistics.n.pixels())
    ASSERT_EQ(n, 6);
}

TEST(MultiscaleHardCases, QuarterPixelPieces) {
  const int width = 13, height = 10, spp = 32;
  std::vector<float> radiance;
  for (int i = 0; i < 3 * width * height * spp; ++i)
    radiance.push_back(static_cast<float>(unit_double(mix(4, i))));
  auto recording = RecordedSamples::from_memory("film", width, height, spp, radiance);
  ASSERT_TRUE(recording.has_value());
  std::vector<FilmPosition> film;
  for (int i = 0; i < width * height * spp; ++i) {
    film.push_back(
        {static_cast<float>(unit_double(mix(1, i))), static_cast<float>(unit_double(mix(2, i)))});
  }
  recording->set_sample_film(film);
  PoolOptions options;
  options.pieces_per_side = 2;
  const SamplePool pool =
      test::pool_of(std::make_shared<const RecordedSamples>(std::move(*recording)), options);
  expect_sound_everywhere(pool, width * height * 8);
}

TEST(MultiscaleHardCases, TilesMustFitTheLevels) {
  const SamplePool pool = test::noisy_pool(64, 64, 2);
  MultiscaleOptions options = test::multiscale_options("robust", {{"tile", "24"}});
  const auto result = sample_multiscale(pool, 100, options, {});
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::kUsage);
}

}  // namespace
}  // namespace spool
