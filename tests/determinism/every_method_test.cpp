// Every sampler and every filter of the lists, in each of its presets, gives the same bits
// with 1, 2, 3, 5 and 8 threads, three times each. A method that joins a list joins this test.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/core/random.h"
#include "lib/filters/filters.h"
#include "lib/sampling/samplers.h"
#include "tests/support/memory_pool.h"
#include "tests/support/thread_count.h"

namespace spool {
namespace {

// Enough pieces for loops that stay on one thread below 8192 of them.
constexpr int kWidth = 97, kHeight = 86, kSamples = 8;

// Coloured: sums of grey float samples are often exact in double, whatever their order.
SamplePool noisy_pool() {
  const auto recording = test::memory_recording(kWidth, kHeight, kSamples, [](int x, int y, int s) {
    Rgb value;
    const double level = 0.3 + 0.25 * std::sin(0.13 * x) + (x * 3 + y > 190 ? 0.8 : 0.0);
    for (int c = 0; c < 3; ++c) {
      const double noise = unit_double(mix(7, x, y, s, c));
      value[static_cast<std::size_t>(c)] =
          static_cast<float>(level * (0.5 + noise) + (noise > 0.995 ? 9.0 : 0.0));
    }
    return value;
  });
  auto with_film = std::make_shared<RecordedSamples>(*recording);
  std::vector<FilmPosition> film;
  for (int s = 0; s < kSamples; ++s) {
    film.push_back(
        {static_cast<float>(unit_double(mix(1, s))), static_cast<float>(unit_double(mix(2, s)))});
  }
  with_film->set_pass_film(std::move(film));
  return test::pool_of(with_film);
}

std::vector<std::string> presets_of(const auto& entry) {
  return entry.presets.empty() ? std::vector<std::string>{""} : entry.presets;
}

// same(result, expected, where) compares; run() is called for each number of threads.
template <class Run, class Same>
void expect_same_bits(const std::string& where, Run&& run, Same&& same) {
  const auto expected = test::with_threads(1, run);
  ASSERT_TRUE(expected.has_value()) << where << ": " << expected.error().message;
  for (const int threads : {1, 2, 3, 5, 8}) {
    for (int repeat = 0; repeat < 3; ++repeat) {
      const auto result = test::with_threads(threads, run);
      ASSERT_TRUE(result.has_value()) << where;
      same(*result, *expected, where + ", threads: " + std::to_string(threads));
    }
  }
}

TEST(EveryMethodDeterminism, BitsOfSamplersDoNotDependOnThreads) {
  const SamplePool pool = noisy_pool();
  SamplingContext context;
  context.seed = 11;
  context.filter = [](const Selection& selection, const SamplePool&) -> Result<RgbImage> {
    GuardCounts guards;
    return pixel_means(selection.statistics, guards);
  };
  const long long budget = 3LL * kWidth * kHeight + 7;
  for (const Sampler& entry : samplers()) {
    for (const std::string& preset : presets_of(entry)) {
      const auto sampler = make_method(samplers(), {entry.name, preset, {}});
      ASSERT_TRUE(sampler.has_value()) << sampler.error().message;
      expect_same_bits(
          entry.name + ":" + preset, [&] { return (*sampler)(pool, budget, context); },
          [](const SamplingResult& a, const SamplingResult& b, const std::string& where) {
            EXPECT_EQ(a.selection.statistics, b.selection.statistics) << where;
            EXPECT_EQ(a.selection.attenuation, b.selection.attenuation) << where;
            EXPECT_EQ(a.log.samples_of_level, b.log.samples_of_level) << where;
            EXPECT_EQ(a.log.guards, b.log.guards) << where;
          });
    }
  }
}

TEST(EveryMethodDeterminism, BitsOfFiltersDoNotDependOnThreads) {
  const SamplePool pool = noisy_pool();
  const auto sampler = make_method(samplers(), {"multiscale", "", {{"epochs", "8"}}});
  const auto sampled = (*sampler)(pool, 4LL * kWidth * kHeight, SamplingContext{});
  ASSERT_TRUE(sampled.has_value());
  const Reference reference{sampled->selection.statistics.mean, std::nullopt};
  FilterContext context;
  context.reference = &reference;  // for oracles
  for (const Filter& entry : filters()) {
    for (const std::string& preset : presets_of(entry)) {
      const auto filter = make_method(filters(), {entry.name, preset, {}});
      ASSERT_TRUE(filter.has_value()) << filter.error().message;
      expect_same_bits(
          entry.name + ":" + preset, [&] { return (*filter)(sampled->selection, pool, context); },
          [](const Reconstruction& a, const Reconstruction& b, const std::string& where) {
            EXPECT_EQ(a.image, b.image) << where;
            EXPECT_EQ(a.variance, b.variance) << where;
            EXPECT_EQ(a.level, b.level) << where;
            EXPECT_EQ(a.guards, b.guards) << where;
          });
    }
  }
}

}  // namespace
}  // namespace spool
