#include "lib/statistics/block_means.h"

#include <gtest/gtest.h>

#include "lib/core/parallel.h"
#include "lib/statistics/means_pass.h"
#include "lib/statistics/piece_statistics.h"
#include "tests/statistics/statistics_cases.h"
#include "tests/support/tiled_recording.h"

namespace spool {
namespace {

using test::Kept;
using test::uneven_counts;
using test::wild_radiance;

// The slow twin: one sample after the other through the pool.
RgbImage one_by_one(const SamplePool& pool, const CountImage& counts) {
  PieceStatistics statistics = empty_statistics(pool);
  for (int y = 0; y < pool.height(); ++y) {
    for (int x = 0; x < pool.width(); ++x) {
      for (int i = 0; i < counts(x, y); ++i)
        add_sample(statistics, counts.index(x, y), pool.sample(x, y, i));
    }
  }
  return statistics.mean;
}

struct Cut {
  int width, height, spp, tile_size, block_spp;
};

constexpr Cut kCuts[] = {{37, 21, 45, 16, 19}, {64, 9, 33, 64, 32}, {5, 3, 40, 8, 40},
                         {24, 17, 7, 8, 3},    {16, 16, 64, 16, 1}, {70, 3, 64, 64, 64}};

TEST(BlockMeans, HaveTheBitsOfOneSampleAfterTheOther) {
  for (const Cut& cut : kCuts) {
    const auto whole = test::memory_recording(cut.width, cut.height, cut.spp, wild_radiance);
    const CountImage counts = uneven_counts(cut.width, cut.height, cut.spp);
    const CountImage all(cut.width, cut.height, cut.spp);
    for (const Kept kept : {Kept::kInPlace, Kept::kReadAgain}) {
      const SamplePool pool =
          test::pool_of(test::tiled_recording(*whole, cut.tile_size, cut.block_spp, kept));
      for (const CountImage* n : {&counts, &all}) {
        const PieceStatistics means = prefix_means(pool, *n);
        EXPECT_EQ(means.mean, one_by_one(pool, *n));
        EXPECT_EQ(means.n, *n);
        EXPECT_TRUE(means.m2[0].empty() && means.analysis.mean.empty());
      }
    }
  }
}

TEST(BlockMeans, AreThoseOfAPoolInAnyOrder) {
  const auto recording = test::memory_recording(20, 12, 16, wild_radiance);
  PoolOptions shuffled;
  shuffled.order = PoolOrder::kShuffled;
  const CountImage counts(20, 12, 7);
  for (const SamplePool& pool :
       {test::pool_of(recording, shuffled), test::pool_of(recording).half(1)}) {
    EXPECT_EQ(prefix_means(pool, counts).mean, one_by_one(pool, counts));
  }
}

// The recording of `whole`, which `pass` sees while it is made.
SamplePool seen(const RecordedSamples& whole, const Cut& cut, Kept kept, FirstPass& pass,
                const PoolOptions& options = {}) {
  const LayerGrid grid{cut.width, cut.height, cut.spp, cut.tile_size, cut.block_spp};
  LayerBlocks radiance(grid, 3, test::reader_of(test::cut_blocks(whole, grid), kept));
  auto made = RecordedSamples::create("seen", std::move(radiance), false, {}, &pass);
  return test::pool_of(std::make_shared<const RecordedSamples>(std::move(*made)), options);
}

TEST(MeansPass, HasTheBitsOfTheMeansOnAnyNumberOfThreads) {
  for (const Cut& cut : kCuts) {
    const auto whole = test::memory_recording(cut.width, cut.height, cut.spp, wild_radiance);
    for (const int spp : {0, 1, 5, cut.spp}) {
      for (const int threads : {1, 2, 3, 8}) {
        const ThreadLimit limit(threads);
        MeansPass pass(spp, 0);
        const SamplePool pool =
            seen(*whole, cut, threads == 1 ? Kept::kReadAgain : Kept::kInPlace, pass);
        const auto taken = std::move(pass).taken(pool);
        ASSERT_TRUE(taken.has_value());
        const CountImage n(cut.width, cut.height, spp == 0 ? cut.spp : spp);
        EXPECT_EQ(*taken, prefix_means(pool, n));
      }
    }
  }
}

TEST(MeansPass, SaysNothingOfSamplesThatItHasNotSeen) {
  const Cut cut = kCuts[0];
  const auto whole = test::memory_recording(cut.width, cut.height, cut.spp, wild_radiance);
  PoolOptions shuffled, late, held_out;
  shuffled.order = PoolOrder::kShuffled;
  late.start = 0.5;
  held_out.holdout = 3;
  const auto taken = [&](int spp, int holdout, const PoolOptions& options) {
    MeansPass pass(spp, holdout);
    const SamplePool pool = seen(*whole, cut, Kept::kInPlace, pass, options);
    return std::move(pass).taken(pool);
  };
  EXPECT_FALSE(taken(0, 0, shuffled).has_value());
  EXPECT_FALSE(taken(0, 0, late).has_value());
  EXPECT_FALSE(taken(0, 0, held_out).has_value());  // it has seen more than the pool has
  EXPECT_FALSE(taken(cut.spp + 1, 0, {}).has_value());
  ASSERT_TRUE(taken(0, 3, held_out).has_value());
  EXPECT_EQ(taken(0, 3, held_out)->n(0, 0), cut.spp - 3);
  MeansPass unseen(0, 0);
  EXPECT_FALSE(std::move(unseen).taken(test::pool_of(whole)).has_value());
}

}  // namespace
}  // namespace spool
