#include "lib/pyramid/region_mean.h"

#include <gtest/gtest.h>

#include "tests/reference/region_mean_reference.h"
#include "tests/reference/test_images.h"

namespace spool {
namespace {

using reference::noise_image;

TEST(RegionMean, LevelZeroIsTheImage) {
  const Plane image = noise_image(13, 7, 1);
  EXPECT_EQ(region_mean(image, 0), image);
}

TEST(RegionMean, RegionOfLevelKIsTwoToTheKWideAndClipped) {
  const Rectangle bounds{0, 0, 40, 30};
  EXPECT_EQ(region(20, 15, 1, bounds), (Rectangle{19, 14, 21, 16}));
  EXPECT_EQ(region(20, 15, 3, bounds), (Rectangle{16, 11, 24, 19}));
  EXPECT_EQ(region(0, 29, 2, bounds), (Rectangle{0, 27, 2, 30}));
  EXPECT_EQ(region(20, 15, 4, bounds).area(), 256);
}

TEST(RegionMean, MeanOfAConstantIsTheConstant) {
  for (int level = 0; level <= 6; ++level) {
    const Plane mean = region_mean(Plane(33, 21, 0.75), level);
    for (const double value : mean.pixels())
      EXPECT_EQ(value, 0.75);
  }
}

// What a summed-area table would break: a firefly elsewhere leaves a black region exactly black.
TEST(RegionMean, FireflyDoesNotLeakOutOfItsRegion) {
  Plane image(64, 64);
  image(3, 3) = 1e15;
  image(40, 40) = 1e-15;
  const Plane mean = region_mean(image, 2);
  EXPECT_EQ(mean(41, 41), 1e-15 / 16.0);
  EXPECT_EQ(mean(60, 60), 0.0);
}

// The order of a sum is part of the result: 1e16 + 1 is 1e16, but 1e16 + (1 + 1) is not.
TEST(RegionMean, RowsAreAddedOneByOneFromTheTop) {
  Plane image(16, 24);
  for (int y = 5; y < 24; ++y)
    image(8, y) = 1.0;
  image(8, 4) = 1e16;
  for (const auto& [level, y] : {std::pair{3, 8}, {4, 12}})
    EXPECT_EQ(region_sum(image, level)(8, y), 1e16) << level;
}

TEST(RegionMean, InfluenceIsWhereTheRegionMeetsTheChange) {
  const Rectangle bounds{0, 0, 48, 48}, changed{20, 10, 22, 11};
  for (int level = 0; level <= 4; ++level) {
    const Rectangle influence = region_influence(changed, level, bounds);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 48; ++x) {
        const bool meets = !intersect(region(x, y, level, bounds), changed).empty();
        EXPECT_EQ(meets, influence.contains(x, y));
      }
    }
  }
}

}  // namespace
}  // namespace spool
