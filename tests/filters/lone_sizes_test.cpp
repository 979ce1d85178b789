// Sizes that stand alone.
#include "lib/filters/directional/lone_sizes.h"

#include <gtest/gtest.h>

#include "lib/core/random.h"
#include "tests/reference/lone_sizes_reference.h"

namespace spool {
namespace {

constexpr int kWide = 11, kHigh = 9;

CountImage sizes(int level) {
  return CountImage(kWide, kHigh, level);
}

TEST(LoneSizes, ADotGoesAndALineStays) {
  CountImage dot = sizes(4), line = sizes(4), diagonal = sizes(4), edge = sizes(4);
  dot(5, 4) = dot(6, 4) = 0;
  for (int x = 0; x < kWide; ++x)
    line(x, 4) = 0;
  for (int y = 0; y < kHigh; ++y)
    diagonal(y + 1, y) = 1;
  for (int y = 0; y < kHigh; ++y) {
    for (int x = 6; x < kWide; ++x)
      edge(x, y) = 0;
  }
  const Plane even(kWide, kHigh, 1.0);
  EXPECT_EQ(without_lone_sizes(dot, {}, even), sizes(4));
  EXPECT_EQ(without_lone_sizes(line, {}, even), line);
  EXPECT_EQ(without_lone_sizes(edge, {}, even), edge);
  const CountImage kept = without_lone_sizes(diagonal, {}, even);
  for (int y = 2; y < kHigh - 2; ++y)
    EXPECT_EQ(kept(y + 1, y), 1);
}

TEST(LoneSizes, ALampOfOnePieceStaysAndADarkPieceGoes) {
  CountImage level = sizes(3);
  Plane kept(kWide, kHigh), mean(kWide, kHigh, 1.0);
  level(2, 2) = level(8, 6) = 0;
  kept(2, 2) = kept(8, 6) = 1.0;
  mean(2, 2) = 4.1;
  mean(8, 6) = 0.0;
  const CountImage opened = without_lone_sizes(level, kept, mean);
  EXPECT_EQ(opened(2, 2), 0);
  EXPECT_EQ(opened(8, 6), 3);
  mean(2, 2) = 4.0;
  EXPECT_EQ(without_lone_sizes(level, kept, mean)(2, 2), 3);
  mean(2, 2) = 100.0;
  EXPECT_EQ(without_lone_sizes(level, Plane(kWide, kHigh), mean)(2, 2), 3);
}

TEST(LoneSizes, AgreesWithTheSlowTwin) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CountImage level(13, 7);
    Plane kept(13, 7), mean(13, 7);
    for (std::size_t i = 0; i < level.size(); ++i) {
      const auto drawn = [&](int which) { return unit_double(mix(seed, i, which)); };
      level[i] = drawn(0) < 0.6 ? 4 : static_cast<int>(5.0 * drawn(1));
      kept[i] = drawn(2) < 0.3 ? 1.0 : 0.0;
      mean[i] = drawn(3) < 0.1 ? 9.0 : drawn(4);
    }
    EXPECT_EQ(without_lone_sizes(level, kept, mean),
              reference::without_lone_sizes(level, kept, mean));
  }
}

}  // namespace
}  // namespace spool
