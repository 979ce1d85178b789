#include "lib/sampling/tile_plan.h"

#include <gtest/gtest.h>

#include "lib/core/image.h"

namespace spool {
namespace {

TEST(TilePlan, TilesCoverEveryPieceOnce) {
  for (const int width : {1, 15, 16, 17, 31, 32, 97, 130}) {
    for (const int height : {1, 9, 48, 61}) {
      const auto tiles = plan_tiles(width, height, 32, 16);
      ASSERT_TRUE(tiles.has_value());
      CountImage covered(width, height);
      for (const Rectangle& tile : *tiles) {
        for (int y = tile.y0; y < tile.y1; ++y) {
          for (int x = tile.x0; x < tile.x1; ++x)
            ++covered(x, y);
        }
      }
      for (const auto count : covered.pixels())
        ASSERT_EQ(count, 1) << width << "x" << height;
    }
  }
}

TEST(TilePlan, NarrowLastTilesJoinTheirNeighbour) {
  const auto tiles = plan_tiles(17, 16, 16, 16);
  ASSERT_TRUE(tiles.has_value());
  ASSERT_EQ(tiles->size(), 1u);
  EXPECT_EQ(tiles->front(), (Rectangle{0, 0, 17, 16}));
  const auto wide = plan_tiles(48, 16, 32, 16);
  ASSERT_EQ(wide->size(), 2u);
  EXPECT_EQ(wide->at(1), (Rectangle{32, 0, 48, 16}));
}

TEST(TilePlan, ZeroMeansOneTile) {
  const auto tiles = plan_tiles(100, 50, 0, 16);
  ASSERT_EQ(tiles->size(), 1u);
  EXPECT_EQ(tiles->front(), (Rectangle{0, 0, 100, 50}));
}

TEST(TilePlan, SizeMustBeAMultipleOfTheLargestRegion) {
  for (const int size : {8, 20, 15}) {
    const auto tiles = plan_tiles(100, 100, size, 16);
    ASSERT_FALSE(tiles.has_value()) << size;
    EXPECT_EQ(tiles.error().code, ErrorCode::kUsage);
  }
}

}  // namespace
}  // namespace spool
