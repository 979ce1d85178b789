// Whether samples lie at edges.
#include "lib/statistics/edge_share.h"

#include <cmath>

#include <gtest/gtest.h>

namespace spool {
namespace {

// Dark left of column 20, bright from there on, of 40 x 40 pixels.
Plane step(double dark, double bright) {
  Plane image(40, 40);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x)
      image(x, y) = x < 20 ? dark : bright;
  }
  return image;
}

// One sample of each pixel, and three of those of one column.
Image<int> column(int at, int pieces = 1) {
  Image<int> counts(40 * pieces, 40 * pieces, 1);
  for (int y = 0; y < counts.height(); ++y)
    counts(at * pieces, y) = 3;
  return counts;
}

TEST(EdgeShare, CountsWhatIsWithinTwoPixels) {
  // Columns 19 and 20 have a gradient; 17 to 22 are near.
  for (const int at : {17, 19, 20, 22})
    EXPECT_EQ(edge_share(column(at), step(1, 4)), 1.0) << at;
  for (const int at : {0, 16, 23, 39})
    EXPECT_EQ(edge_share(column(at), step(1, 4)), 0.0) << at;
  EXPECT_EQ(edge_share(column(19, 2), step(1, 4)), 1.0);
  EXPECT_EQ(edge_share(column(16, 2), step(1, 4)), 0.0);
}

TEST(EdgeShare, TakesSamplesAboveTheSmallestCount) {
  Image<int> counts = column(20);
  counts(0, 0) = 81;
  EXPECT_EQ(edge_share(counts, step(1, 4)), 0.5);
}

TEST(EdgeShare, IsThatOfTheExposedImage) {
  for (const double exposure : {1e-6, 1.0, 1e6})
    EXPECT_EQ(edge_share(column(20), step(exposure, 4 * exposure)), 1.0);
}

// A soft gradient everywhere has no edges but its steepest tenth.
TEST(EdgeShare, EdgesAreTheSteepestTenth) {
  Plane image = step(1, 1);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x)
      image(x, y) = std::exp(0.001 * x * x);
  }
  EXPECT_EQ(edge_share(column(38), image), 1.0);
  EXPECT_EQ(edge_share(column(20), image), 0.0);
}

TEST(EdgeShare, NoiseOfBlackPixelsMakesNone) {
  Plane image = step(1, 4);
  image(5, 5) = 1e-12;
  image(6, 5) = 1e-9;
  image(8, 8) = -1e-9;
  Plane without = step(1, 4);
  for (const auto& [x, y] : {std::pair{5, 5}, {6, 5}, {8, 8}})
    without(x, y) = 1e-20;
  EXPECT_EQ(edge_share(column(5), image), edge_share(column(5), without));
}

TEST(EdgeShare, IsNotKnownWithoutEdgesOrVariation) {
  EXPECT_TRUE(std::isnan(edge_share(column(20), step(2, 2))));
  EXPECT_TRUE(std::isnan(edge_share(Image<int>(40, 40, 4), step(1, 4))));
  EXPECT_TRUE(std::isnan(edge_share(Image<int>(), Plane())));
  EXPECT_TRUE(std::isnan(edge_share(column(20), Plane(40, 40, std::nan("")))));
  Plane holes = step(1, 4);
  holes(30, 3) = std::nan("");
  EXPECT_EQ(edge_share(column(20), holes), 1.0);
}

}  // namespace
}  // namespace spool
