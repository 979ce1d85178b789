#include "lib/pool/layer_blocks.h"

#include <atomic>

#include <gtest/gtest.h>

#include "lib/core/parallel.h"
#include "tests/support/memory_pool.h"
#include "tests/support/tiled_recording.h"

namespace spool {
namespace {

using test::Kept;

Rgb numbered(int x, int y, int s) {
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(s)};
}

TEST(LayerBlocks, GiveTheSameValuesInPlaceAndReadAgain) {
  const auto whole = test::memory_recording(13, 9, 11, numbered);
  for (const Kept kept : {Kept::kInPlace, Kept::kReadAgain}) {
    const auto tiled = test::tiled_recording(*whole, 8, 4, kept);
    parallel_rows(0, 9, [&](int y) {
      for (int x = 0; x < 13; ++x) {
        for (int s = 0; s < 11; ++s)
          EXPECT_EQ(tiled->radiance(x, y, s), numbered(x, y, s));
      }
    });
    const LayerBlocks& blocks = tiled->blocks();
    const BlockView last = blocks.view(3, 2);  // 5 x 1 pixels, samples 8 to 10
    EXPECT_EQ(last.pixels, (Rectangle{8, 8, 13, 9}));
    EXPECT_EQ(last.first, 8);
    EXPECT_EQ(last.samples, 3);
    EXPECT_EQ(last.at(9, 8)[0], 9.0f);
    EXPECT_EQ(last.at(9, 8)[2 * last.channel() + 1], 9.0f);  // blue: the sample's number
  }
}

TEST(LayerBlocks, KeepWhatTheyAreToldToKeep) {
  const auto whole = test::memory_recording(16, 8, 4, numbered);
  const LayerGrid grid{16, 8, 4, 8, 2};
  const BlockReader copies = test::reader_of(test::cut_blocks(*whole, grid), Kept::kReadAgain);
  for (const bool keep : {false, true}) {
    std::atomic<int> reads{0};
    LayerBlocks layer(grid, 3, [&](std::size_t i) {
      ++reads;
      return copies(i);
    });
    ASSERT_TRUE(layer.read_all({.keep = keep}, [](const BlockView&) { return Result<void>(); })
                    .has_value());
    EXPECT_EQ(layer.in_place(), keep);
    EXPECT_EQ(reads, 4);
    EXPECT_EQ(layer.place_of(9, 3, 2).value[0], 9.0f);
    EXPECT_EQ(reads, keep ? 4 : 5);
    EXPECT_EQ(layer.place_of(9, 3, 3).value[0], 9.0f);  // of the same block
    EXPECT_EQ(reads, keep ? 4 : 5);
  }
}

TEST(LayerBlocks, HoldZerosAndSayWhyWhereABlockIsNoLongerRead) {
  const auto whole = test::memory_recording(8, 8, 4, [](int, int, int) { return Rgb{1, 1, 1}; });
  const LayerGrid grid{8, 8, 4, 8, 2};
  const BlockReader copies = test::reader_of(test::cut_blocks(*whole, grid), Kept::kReadAgain);
  bool lost = false;
  LayerBlocks layer(grid, 3, [&](std::size_t i) -> Result<BlockValues> {
    if (lost) return fail(ErrorCode::kDamage, "gone");
    return copies(i);
  });
  ASSERT_TRUE(layer.read_all({}, [](const BlockView&) { return Result<void>(); }).has_value());
  EXPECT_EQ(layer.place_of(1, 1, 3).value[0], 1.0f);
  lost = true;
  EXPECT_TRUE(layer.failure().has_value());
  const LayerBlocks::Place place = layer.place_of(1, 1, 0);
  EXPECT_EQ(place.value[0], 0.0f);
  EXPECT_EQ(place.value[2 * place.channel], 0.0f);
  ASSERT_FALSE(layer.failure().has_value());
  EXPECT_EQ(layer.failure().error().message, "gone");
}

TEST(LayerBlocks, SayTheFirstErrorByIndex) {
  const LayerGrid grid{64, 64, 4, 8, 2};
  LayerBlocks layer(grid, 3, [](std::size_t i) -> Result<BlockValues> {
    return fail(ErrorCode::kDamage, "block {}", i);
  });
  const auto read = layer.read_all({.keep = true}, [](const BlockView&) { return Result<void>(); });
  ASSERT_FALSE(read.has_value());
  EXPECT_EQ(read.error().message, "block 0");
}

}  // namespace
}  // namespace spool
