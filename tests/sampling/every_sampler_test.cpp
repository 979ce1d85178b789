// Laws that every sampler of the list must keep.
#include <limits>

#include <gtest/gtest.h>

#include "lib/core/parallel.h"
#include "lib/sampling/samplers.h"
#include "lib/sampling/spending.h"
#include "lib/statistics/joined_halves.h"
#include "tests/sampling/multiscale_cases.h"

namespace spool {
namespace {

SamplingContext context_with_filter() {
  SamplingContext context;
  context.seed = 11;
  context.filter = [](const Selection& selection, const SamplePool&) -> Result<RgbImage> {
    GuardCounts guards;
    return pixel_means(selection.statistics, guards);
  };
  return context;
}

ReadySampler sampler_of(const std::string& name) {
  OptionValues set;
  if (name == "nl_means") set = {{"window", "3"}, {"patch", "1"}};  // fast enough for tests
  return *make_method(samplers(), {name, "", set});
}

TEST(EverySampler, SpendsTheBudgetExactlyInsideThePool) {
  const SamplingContext context = context_with_filter();
  for (const Sampler& entry : samplers()) {
    const ReadySampler sampler = sampler_of(entry.name);
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {17, 16}, {23, 11}}) {
      const SamplePool pool = test::noisy_pool(width, height, 9);
      const long long pieces = width * height;
      for (const long long budget : {0LL, 1LL, pieces / 2 + 1, pieces, 2 * pieces, 3 * pieces + 1,
                                     5 * pieces, 8 * pieces + 3, 9 * pieces, 20 * pieces}) {
        const auto result = sampler(pool, budget, context);
        ASSERT_TRUE(result.has_value()) << entry.name << ": " << result.error().message;
        const CountImage& n = result->selection.statistics.n;
        const long long possible = std::min(budget, pool.total_capacity());
        EXPECT_EQ(test::total(n), possible) << entry.name << " " << width << "x" << height;
        EXPECT_EQ(result->log.spent, possible) << entry.name;
        EXPECT_EQ(result->log.budget, budget) << entry.name;
        EXPECT_LE(result->log.initial, possible) << entry.name;
        EXPECT_EQ(result->log.saturated_pieces, count_saturated(pool, n)) << entry.name;
        for (const auto count : n.pixels())
          ASSERT_TRUE(count >= 0 && count <= 9) << entry.name;
      }
    }
  }
}

TEST(EverySampler, StatisticsAreThoseOfThePrefixes) {
  const SamplingContext context = context_with_filter();
  const SamplePool pool = test::noisy_pool(14, 12, 9);
  for (const Sampler& entry : samplers()) {
    const auto result = sampler_of(entry.name)(pool, 14 * 12 * 6, context);
    ASSERT_TRUE(result.has_value());
    const PieceStatistics& s = result->selection.statistics;
    PieceStatistics again = prefix_statistics(pool, s.n, s.signal);
    std::vector<Selection> halves;
    for (const Selection& half : result->selection.halves) {
      halves.push_back({prefix_statistics(pool.half(static_cast<int>(halves.size())),
                                          half.statistics.n, s.signal),
                        {}});
    }
    if (!halves.empty()) again = join_halves(pool, std::move(halves)).statistics;
    EXPECT_EQ(s, again) << entry.name;  // to the last bit, whichever way the samples were taken
    EXPECT_NE(s.signal.exposure, 1.0) << entry.name;
  }
}

TEST(EverySampler, ButTheOracleLooksOnlyBehindTheCursor) {
  const int width = 13, height = 11, spp = 12;
  const SamplingContext context = context_with_filter();
  for (const Sampler& entry : samplers()) {
    if (entry.name == "neyman") continue;
    auto values = std::make_shared<std::vector<float>>(3u * width * height * spp);
    const std::size_t plane = static_cast<std::size_t>(width) * height * spp;
    const auto fill = [&](const CountImage* n) {
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          for (int s = n != nullptr ? (*n)(x, y) : 0; s < spp; ++s) {
            for (std::size_t c = 0; c < 3; ++c) {
              (*values)[c * plane + (static_cast<std::size_t>(y) * width + x) * spp + s] =
                  n != nullptr ? std::numeric_limits<float>::quiet_NaN()
                               : test::varied_noise(width, x, y, s)[c];
            }
          }
        }
      }
    };
    fill(nullptr);
    auto recording = RecordedSamples::create(
        "poison", {{width, height, spp, width, spp}, {values->data()}}, values);
    ASSERT_TRUE(recording.has_value());
    test::add_features(*recording);
    const SamplePool pool =
        test::pool_of(std::make_shared<const RecordedSamples>(std::move(*recording)));
    const auto clean = sampler_of(entry.name)(pool, width * height * 6, context);
    ASSERT_TRUE(clean.has_value());
    // The recording was checked at load; writing to its storage now bypasses every rule.
    const CountImage cursor = looked_at(clean->selection);
    fill(&cursor);
    const auto poisoned = sampler_of(entry.name)(pool, width * height * 6, context);
    ASSERT_TRUE(poisoned.has_value());
    EXPECT_EQ(poisoned->selection.statistics, clean->selection.statistics) << entry.name;
  }
}

TEST(EverySampler, ExposureByPowersOfTwoChangesNoCount) {
  const SamplingContext context = context_with_filter();
  for (const Sampler& entry : samplers()) {
    CountImage expected;
    for (const float factor : {1.0f, 0x1p-20f, 0x1p13f}) {
      const SamplePool pool = test::memory_pool(15, 12, 9, [&](int x, int y, int s) {
        Rgb value = test::varied_noise(15, x, y, s);
        for (float& v : value)
          v *= factor;
        return value;
      });
      const auto result = sampler_of(entry.name)(pool, 15 * 12 * 6, context);
      ASSERT_TRUE(result.has_value());
      if (expected.empty()) expected = result->selection.statistics.n;
      EXPECT_EQ(result->selection.statistics.n, expected) << entry.name << " " << factor;
    }
  }
}

TEST(EverySampler, BlackAndSparsePoolsAreSpentToo) {
  const SamplingContext context = context_with_filter();
  const SamplePool black = test::memory_pool(12, 9, 8, [](int, int, int) { return Rgb{0, 0, 0}; });
  SanitiseRules rules;
  rules.allow_many_rejected = true;
  const SamplePool sparse = test::memory_pool(
      12, 9, 8,
      [](int x, int y, int s) {
        Rgb value = test::varied_noise(12, x, y, s);
        if (mix(9, x, y, s) % 5 == 0 || (x == 3 && y == 4)) {
          value[0] = std::numeric_limits<float>::infinity();
        }
        return value;
      },
      rules);
  for (const Sampler& entry : samplers()) {
    for (const SamplePool* pool : {&black, &sparse}) {
      const auto result = sampler_of(entry.name)(*pool, 12 * 9 * 5, context);
      ASSERT_TRUE(result.has_value()) << entry.name << ": " << result.error().message;
      EXPECT_EQ(result->log.spent, 12 * 9 * 5) << entry.name;
    }
  }
}

TEST(EverySampler, WhereNothingDecidesSamplesAreSpreadEvenly) {
  const SamplePool black = test::memory_pool(12, 9, 16, [](int, int, int) { return Rgb{0, 0, 0}; });
  for (const char* name : {"uniform", "multiscale", "adaptive_wavelet", "nl_means",
                           "denoised_variance", "filtered_halves", "neyman"}) {
    for (const long long budget : {12 * 9 * 4, 12 * 9 * 5 + 7}) {
      const auto result = sampler_of(name)(black, budget, context_with_filter());
      ASSERT_TRUE(result.has_value()) << name;
      const auto [least, most] = std::ranges::minmax(result->selection.statistics.n.pixels());
      EXPECT_LE(most - least, 1) << name << " " << budget;
    }
  }
}

TEST(EverySamplerDeterminism, ThreadsDoNotChangeABit) {
  const SamplingContext context = context_with_filter();
  const SamplePool pool = test::noisy_pool(96, 90, 12);
  for (const Sampler& entry : samplers()) {
    if (entry.name == "multiscale") continue;  // has its own test
    SamplingResult expected;
    for (const int threads : {1, 2, 8}) {
      const ThreadLimit limit(threads);
      const auto result = sampler_of(entry.name)(pool, 96 * 90 * 6, context);
      ASSERT_TRUE(result.has_value());
      if (threads == 1) expected = *result;
      EXPECT_EQ(result->selection.statistics, expected.selection.statistics) << entry.name;
    }
  }
}

}  // namespace
}  // namespace spool
