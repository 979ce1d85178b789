#include "lib/statistics/block_statistics.h"

#include <gtest/gtest.h>

#include "lib/core/parallel.h"
#include "lib/statistics/piece_statistics.h"
#include "tests/statistics/statistics_cases.h"
#include "tests/support/tiled_recording.h"

namespace spool {
namespace {

using test::Kept;
using test::uneven_counts;
using test::wild_radiance;

// The slow twin: one sample after the other through the pool.
PieceStatistics one_by_one(const SamplePool& pool, const CountImage& counts,
                           const AnalysisSignal& signal) {
  PieceStatistics statistics = empty_statistics(pool, signal);
  for (int y = 0; y < pool.height(); ++y) {
    for (int x = 0; x < pool.width(); ++x) {
      for (int i = 0; i < counts(x, y); ++i)
        add_sample(statistics, counts.index(x, y), pool.sample(x, y, i));
    }
  }
  return statistics;
}

struct Cut {
  int width, height, spp, tile_size, block_spp;
};

TEST(BlockStatistics, HaveTheBitsOfOneSampleAfterTheOther) {
  AnalysisSignal bright;
  bright.exposure = 1.0 / 3.0;
  for (const Cut& cut : {Cut{37, 21, 45, 16, 19}, Cut{64, 9, 33, 64, 32}, Cut{5, 3, 40, 8, 40},
                         Cut{24, 17, 7, 8, 3}, Cut{16, 16, 64, 16, 1}}) {
    const auto whole = test::memory_recording(cut.width, cut.height, cut.spp, wild_radiance);
    const CountImage counts = uneven_counts(cut.width, cut.height, cut.spp);
    const CountImage all(cut.width, cut.height, cut.spp);
    for (const Kept kept : {Kept::kInPlace, Kept::kReadAgain}) {
      const SamplePool pool =
          test::pool_of(test::tiled_recording(*whole, cut.tile_size, cut.block_spp, kept));
      ASSERT_TRUE(pool.as_recorded());
      ASSERT_EQ(pool.recording().blocks().in_place(), kept == Kept::kInPlace);
      for (const CountImage* n : {&counts, &all}) {
        for (const AnalysisSignal& signal : {AnalysisSignal{}, bright}) {
          const PieceStatistics slow = one_by_one(pool, *n, signal);
          EXPECT_EQ(prefix_statistics(pool, *n, signal), slow);
          PieceStatistics exposed = prefix_statistics(pool, *n);
          set_signal(exposed, pool, signal);
          EXPECT_EQ(exposed, slow);
        }
      }
    }
  }
}

TEST(BlockStatistics, AreLeftOutWhereSamplesDoNotLieAsTheyAreTaken) {
  const auto recording = test::memory_recording(20, 12, 16, wild_radiance);
  PoolOptions shuffled;
  shuffled.order = PoolOrder::kShuffled;
  shuffled.seed = 3;
  PoolOptions late;
  late.start = 0.25;
  const SamplePool plain = test::pool_of(recording);
  for (const SamplePool& pool : {test::pool_of(recording, shuffled), test::pool_of(recording, late),
                                 plain.half(1), plain.with_limits(Plane(20, 12, 0.5))}) {
    EXPECT_FALSE(pool.as_recorded());
    const CountImage counts(20, 12, 7);
    EXPECT_EQ(prefix_statistics(pool, counts), one_by_one(pool, counts, {}));
  }
}

TEST(BlockStatistics, LanesWithoutSamplesKeepWhatTheyHave) {
  const SamplePool pool = test::pool_of(test::memory_recording(8, 1, 9, wild_radiance));
  CountImage counts(8, 1);
  counts(3, 0) = 9;
  const PieceStatistics statistics = prefix_statistics(pool, counts);
  EXPECT_EQ(statistics, one_by_one(pool, counts, {}));
  EXPECT_EQ(statistics.analysis.minimum(2, 0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(statistics.mean[0](4, 0), 0.0);
}

TEST(BlockStatistics, BitsDoNotDependOnTheNumberOfThreads) {
  const auto whole = test::memory_recording(40, 31, 9, wild_radiance);
  const CountImage counts = uneven_counts(40, 31, 9);
  for (const Kept kept : {Kept::kInPlace, Kept::kReadAgain}) {
    const SamplePool pool = test::pool_of(test::tiled_recording(*whole, 16, 4, kept));
    const auto run = [&](int threads) {
      const ThreadLimit limit(threads);
      return prefix_statistics(pool, counts);
    };
    const PieceStatistics once = run(1);
    for (const int threads : {2, 3, 8})
      EXPECT_EQ(run(threads), once);
  }
}

}  // namespace
}  // namespace spool
