#include "lib/pool/sample_pool.h"

#include <algorithm>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "lib/synthetic/scene_s.h"
#include "tests/support/memory_pool.h"

namespace spool {
namespace {

using test::memory_recording;
using test::pool_of;

// A sample that tells where it comes from.
Rgb labelled(int x, int y, int s) {
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(s)};
}

TEST(RecordedSamples, TilesAndBlocksAreAddressedLikeTheFormat) {
  // 5 x 3 pixels in tiles of 2, 5 samples in blocks of 2: [c][y][x][s] in each.
  std::vector<std::vector<float>> blocks;
  for (int ty = 0; ty < 2; ++ty) {
    for (int tx = 0; tx < 3; ++tx) {
      for (int b = 0; b < 3; ++b) {
        std::vector<float> block;
        for (std::size_t c = 0; c < 3; ++c) {
          for (int y = 2 * ty; y < std::min(3, 2 * ty + 2); ++y) {
            for (int x = 2 * tx; x < std::min(5, 2 * tx + 2); ++x) {
              for (int s = 2 * b; s < std::min(5, 2 * b + 2); ++s)
                block.push_back(labelled(x, y, s)[c]);
            }
          }
        }
        blocks.push_back(block);
      }
    }
  }
  RadianceLayout layout{{5, 3, 5, 2, 2}, {}};
  for (const auto& block : blocks)
    layout.blocks.push_back(block.data());
  const auto recording = RecordedSamples::create("tiles", layout, nullptr);
  ASSERT_TRUE(recording.has_value());
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 5; ++x) {
      for (int s = 0; s < 5; ++s)
        EXPECT_EQ(recording->radiance(x, y, s), labelled(x, y, s));
    }
  }
}

TEST(SamplePool, RecordedOrderGivesSamplesAsTheyCame) {
  const SamplePool pool = pool_of(memory_recording(4, 3, 6, labelled));
  for (int s = 0; s < 6; ++s)
    EXPECT_EQ(pool.sample(2, 1, s), labelled(2, 1, s));
  EXPECT_EQ(pool.capacity(2, 1), 6);
  EXPECT_EQ(pool.total_capacity(), 72);
}

TEST(SamplePool, ShufflingKeepsEverySampleAndDiffersBetweenPixelsAndSeeds) {
  PoolOptions options;
  options.order = PoolOrder::kShuffled;
  std::set<std::vector<int>> orders;
  for (const std::uint64_t seed : {1u, 2u}) {
    options.seed = seed;
    const SamplePool pool = pool_of(memory_recording(4, 4, 16, labelled), options);
    for (int y = 0; y < 4; ++y) {
      for (int x = 0; x < 4; ++x) {
        std::vector<int> order, sorted;
        for (int i = 0; i < 16; ++i) {
          EXPECT_EQ(pool.sample(x, y, i), labelled(x, y, pool.recorded_index(x, y, i)));
          order.push_back(pool.recorded_index(x, y, i));
        }
        orders.insert(order);
        sorted = order;
        std::sort(sorted.begin(), sorted.end());
        for (int i = 0; i < 16; ++i)
          EXPECT_EQ(sorted[static_cast<std::size_t>(i)], i);
      }
    }
  }
  EXPECT_EQ(orders.size(), 32u);
}

TEST(SamplePool, BeginsAnywhereOnTheRingOfItsOrder) {
  PoolOptions options;
  options.order = PoolOrder::kShuffled;
  options.seed = 3;
  const auto recording = memory_recording(4, 3, 10, labelled);
  const SamplePool whole = pool_of(recording, options);
  options.start = 0.75;  // 7.5 of 10 samples: from the seventh
  options.holdout = 4;
  const SamplePool turned = pool_of(recording, options);
  for (int i = 0; i < 10; ++i)
    EXPECT_EQ(turned.recorded_index(2, 1, i), whole.recorded_index(2, 1, (7 + i) % 10));
  EXPECT_EQ(turned.capacity(2, 1), 6);
  for (int i = 0; i < 5; ++i)
    EXPECT_EQ(turned.half(1).recorded_index(2, 1, i), whole.recorded_index(2, 1, (8 + 2 * i) % 10));
}

TEST(SamplePool, HoldoutIsNeverOffered) {
  PoolOptions options;
  options.order = PoolOrder::kShuffled;
  options.holdout = 5;
  const SamplePool pool = pool_of(memory_recording(3, 3, 16, labelled), options);
  EXPECT_EQ(pool.capacity(1, 1), 11);
  EXPECT_EQ(pool.size(1, 1), 16);
  EXPECT_EQ(pool.total_capacity(), 99);
  options.holdout = 16;
  const auto none = SamplePool::create(memory_recording(3, 3, 16, labelled), options);
  ASSERT_FALSE(none.has_value());
  EXPECT_EQ(none.error().code, ErrorCode::kData);
}

TEST(SamplePool, QuarterPixelsSplitSamplesByFilmPositionInOrder) {
  auto recording = std::make_shared<const RecordedSamples>(make_scene_s(6, 5, 40, 3));
  PoolOptions options;
  options.pieces_per_side = 2;
  for (const PoolOrder order : {PoolOrder::kRecorded, PoolOrder::kShuffled}) {
    options.order = order;
    const SamplePool pool = pool_of(recording, options);
    EXPECT_EQ(pool.width(), 12);
    EXPECT_EQ(pool.height(), 10);
    for (int y = 0; y < 5; ++y) {
      for (int x = 0; x < 6; ++x) {
        std::vector<int> all;
        for (int piece = 0; piece < 4; ++piece) {
          const int px = 2 * x + piece % 2, py = 2 * y + piece / 2;
          std::vector<int> indices;
          for (int i = 0; i < pool.size(px, py); ++i) {
            const FilmPosition film = pool.film(px, py, i);
            EXPECT_EQ(static_cast<int>(2 * film.x), piece % 2);
            EXPECT_EQ(static_cast<int>(2 * film.y), piece / 2);
            indices.push_back(pool.recorded_index(px, py, i));
            EXPECT_EQ(pool.sample(px, py, i), recording->radiance(x, y, indices.back()));
          }
          if (order == PoolOrder::kRecorded) {
            EXPECT_TRUE(std::is_sorted(indices.begin(), indices.end()));
          }
          all.insert(all.end(), indices.begin(), indices.end());
        }
        std::sort(all.begin(), all.end());
        ASSERT_EQ(all.size(), 40u);
        for (int i = 0; i < 40; ++i)
          EXPECT_EQ(all[static_cast<std::size_t>(i)], i);
      }
    }
  }
}

TEST(SamplePool, AHoldoutThatLeavesNoPieceASampleIsAnError) {
  RecordedSamples samples = *memory_recording(3, 3, 8, labelled);
  std::vector<FilmPosition> film;
  for (int s = 0; s < 8; ++s)
    film.push_back(
        {0.25f + 0.5f * static_cast<float>(s % 2), 0.25f + 0.5f * static_cast<float>(s / 2 % 2)});
  samples.set_pass_film(film);
  const auto recording = std::make_shared<const RecordedSamples>(std::move(samples));
  PoolOptions options;
  options.pieces_per_side = 2;
  options.holdout = 4;
  EXPECT_EQ(pool_of(recording, options).total_capacity(), 36);
  options.holdout = 5;  // 2 of each piece's 2
  const auto none = SamplePool::create(recording, options);
  ASSERT_FALSE(none.has_value());
  EXPECT_EQ(none.error().code, ErrorCode::kData);
  EXPECT_NE(none.error().message.find("holding out 5 of 8 samples leaves none"), std::string::npos);
}

TEST(SamplePool, PiecesGiveUpTheirShareOfTheHoldoutRoundedUp) {
  auto recording = std::make_shared<const RecordedSamples>(make_scene_s(4, 3, 40, 3));
  PoolOptions options;
  options.pieces_per_side = 2;
  options.holdout = 5;  // ceil(5 / 4) = 2 of each piece
  const SamplePool pool = pool_of(recording, options);
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 8; ++x)
      EXPECT_EQ(pool.capacity(x, y), std::max(0, pool.size(x, y) - 2));
  }
}

TEST(SamplePool, HalvesTakeEverySecondSampleAndShareNone) {
  for (const PoolOrder order : {PoolOrder::kRecorded, PoolOrder::kShuffled}) {
    PoolOptions options;
    options.order = order;
    const SamplePool pool = pool_of(memory_recording(3, 2, 7, labelled), options);
    for (int parity = 0; parity < 2; ++parity) {
      const SamplePool half = pool.half(parity);
      ASSERT_EQ(half.size(2, 1), parity == 0 ? 4 : 3);
      EXPECT_EQ(half.capacity(2, 1), half.size(2, 1));
      for (int i = 0; i < half.size(2, 1); ++i)
        EXPECT_EQ(half.recorded_index(2, 1, i), pool.recorded_index(2, 1, 2 * i + parity));
    }
    const SamplePool quarter = pool.half(1).half(1);
    ASSERT_EQ(quarter.size(0, 0), 1);
    EXPECT_EQ(quarter.recorded_index(0, 0, 0), pool.recorded_index(0, 0, 3));
  }
}

TEST(SamplePool, QuarterPixelsNeedFilmPositions) {
  PoolOptions options;
  options.pieces_per_side = 2;
  EXPECT_FALSE(SamplePool::create(memory_recording(2, 2, 4, labelled), options).has_value());
  options.pieces_per_side = 3;
  EXPECT_FALSE(SamplePool::create(memory_recording(2, 2, 4, labelled), options).has_value());
}

Rgb sometimes_nan(int x, int y, int s) {
  if (x == 1 && y == 1 && s % 4 == 1) return {1.0f, std::numeric_limits<float>::quiet_NaN(), 1.0f};
  return labelled(x, y, s);
}

TEST(SamplePool, RejectedSamplesLeaveTheirPixelsPool) {
  SanitiseRules rules;
  rules.allow_many_rejected = true;
  for (const PoolOrder order : {PoolOrder::kRecorded, PoolOrder::kShuffled}) {
    PoolOptions options;
    options.order = order;
    options.holdout = 2;
    const SamplePool pool = pool_of(memory_recording(3, 2, 10, sometimes_nan, rules), options);
    EXPECT_EQ(pool.size(1, 1), 7);  // samples 1, 5, 9 are gone
    EXPECT_EQ(pool.capacity(1, 1), 5);
    EXPECT_EQ(pool.size(0, 1), 10);
    std::set<int> seen;
    for (int i = 0; i < 7; ++i)
      seen.insert(pool.recorded_index(1, 1, i));
    EXPECT_EQ(seen, (std::set<int>{0, 2, 3, 4, 6, 7, 8}));
  }
}

}  // namespace
}  // namespace spool
