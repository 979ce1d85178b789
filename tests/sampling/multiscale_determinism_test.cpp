// Bits do not depend on the number of threads, in any mode.
#include <gtest/gtest.h>

#include "lib/core/parallel.h"
#include "tests/sampling/multiscale_cases.h"
#include "tests/support/scene_s.h"

namespace spool {
namespace {

TEST(MultiscaleDeterminism, ThreadsDoNotChangeABit) {
  // Coloured: sums of grey float samples are exact in double, whatever their order.
  const SamplePool pool = test::noisy_pool(128, 120, 16);
  for (const OptionValues& set : std::vector<OptionValues>{
           {{"update", "epoch"}, {"epochs", "8"}},
           {{"update", "epoch"}, {"epochs", "4"}, {"analysis_channel", "per_channel"}},
           {{"update", "epoch"}, {"epochs", "6"}, {"tile", "32"}, {"parallel", "tiles"}},
           {{"update", "epoch"},
            {"epochs", "4"},
            {"tile", "64"},
            {"tile_halo", "none"},
            {"parallel", "rows"}},
           {{"update", "exact"},
            {"tile", "32"},
            {"levels", "2"},
            {"tile_halo", "none"},
            {"parallel", "tiles"}}}) {
    const MultiscaleOptions options = test::multiscale_options("robust", set);
    SamplingResult expected;
    {
      const ThreadLimit one(1);
      expected = test::run_multiscale(pool, 128 * 120 * 3, options);
    }
    for (const int threads : {1, 2, 3, 5, 8}) {
      const ThreadLimit limit(threads);
      for (int repeat = 0; repeat < 3; ++repeat) {
        const SamplingResult result = test::run_multiscale(pool, 128 * 120 * 3, options);
        ASSERT_EQ(result.selection.statistics, expected.selection.statistics) << threads;
        ASSERT_EQ(result.selection.attenuation, expected.selection.attenuation) << threads;
        ASSERT_EQ(result.log.samples_of_level, expected.log.samples_of_level) << threads;
        ASSERT_EQ(result.log.guards, expected.log.guards) << threads;
      }
    }
  }
}

TEST(MultiscaleDeterminism, RowsOrTilesInParallelIsTheSame) {
  const SamplePool pool = test::scene_s_pool(64, 16, 2);
  MultiscaleOptions options =
      test::multiscale_options("robust", {{"tile", "32"}, {"epochs", "20"}, {"parallel", "tiles"}});
  const SamplingResult tiles = test::run_multiscale(pool, 64 * 64 * 4, options);
  options.parallel = ParallelOver::kRows;
  const SamplingResult rows = test::run_multiscale(pool, 64 * 64 * 4, options);
  EXPECT_EQ(tiles.selection.statistics, rows.selection.statistics);
  EXPECT_EQ(tiles.selection.attenuation, rows.selection.attenuation);
}

}  // namespace
}  // namespace spool
