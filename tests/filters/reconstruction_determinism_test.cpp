// Every filter gives the same bits for any number of threads.
#include <gtest/gtest.h>

#include "lib/core/parallel.h"
#include "lib/filters/filters.h"
#include "tests/filters/small_pools.h"

namespace spool {
namespace {

TEST(ReconstructionDeterminism, BitsDoNotDependOnThreads) {
  std::vector<FilmPosition> film;
  for (int s = 0; s < 8; ++s) {
    film.push_back(
        {static_cast<float>(unit_double(mix(1, s))), static_cast<float>(unit_double(mix(2, s)))});
  }
  const SamplePool pool =
      testing::make_pool(97, 61, 8, testing::noisy_picture(97, 61, 1), {}, film);
  const Selection selection =
      testing::select_counts(pool, [](int x, int y) { return 1 + (5 * x + 3 * y) % 8; });
  const Reference reference{selection.statistics.mean, std::nullopt};
  FilterContext context;
  context.reference = &reference;  // for oracles
  for (const Filter& entry : filters()) {
    std::vector<std::string> presets = entry.presets;
    if (presets.empty()) presets.push_back("");
    for (const std::string& preset : presets) {
      const auto filter = make_method(filters(), {entry.name, preset, {}});
      std::optional<Reconstruction> first;
      for (const int threads : {1, 2, 3, 8}) {
        const ThreadLimit limit(threads);
        auto result = (*filter)(selection, pool, context);
        ASSERT_TRUE(result.has_value());
        if (!first) {
          first = std::move(*result);
          continue;
        }
        EXPECT_EQ(result->image, first->image) << entry.name << " " << preset << " " << threads;
        EXPECT_EQ(result->variance, first->variance) << entry.name << " " << preset;
        EXPECT_EQ(result->level, first->level) << entry.name << " " << preset;
        EXPECT_EQ(result->guards, first->guards) << entry.name << " " << preset;
      }
    }
  }
}

}  // namespace
}  // namespace spool
