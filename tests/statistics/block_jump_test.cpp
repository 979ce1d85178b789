// Jumps of a density at the borders of blocks.
#include "lib/statistics/block_jump.h"

#include <cmath>

#include <gtest/gtest.h>

namespace spool {
namespace {

// Blocks of `side` pixels; neighbours of one block differ by `inside`, those of two by more.
Image<int> blocks(int size, int side, int inside, int between) {
  Image<int> counts(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x)
      counts(x, y) = between * (x / side + y / side) + inside * ((x + y) % 2);
  }
  return counts;
}

TEST(BlockJump, IsOneWithoutBlocks) {
  EXPECT_DOUBLE_EQ(block_jump(blocks(48, 16, 3, 0), 16), 1.0);
}

TEST(BlockJump, IsTheQuotientOfMeanJumps) {
  // At a border the even step of the blocks and the odd one of the pattern add up or cancel by
  // halves: (10 + 2 + 10 - 2) / 2 = 10 beside 2.
  EXPECT_DOUBLE_EQ(block_jump(blocks(48, 16, 2, 10), 16), 5.0);
  // Of other borders none is one of a block.
  EXPECT_LT(block_jump(blocks(48, 16, 2, 10), 5), 1.0);
}

TEST(BlockJump, IsNotKnownWithoutBordersOrVariation) {
  EXPECT_TRUE(std::isnan(block_jump(blocks(16, 16, 1, 0), 16)));
  EXPECT_TRUE(std::isnan(block_jump(blocks(48, 16, 0, 5), 16)));
  EXPECT_TRUE(std::isnan(block_jump(Image<int>(), 16)));
}

}  // namespace
}  // namespace spool
