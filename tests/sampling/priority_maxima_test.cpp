#include "lib/sampling/priority_maxima.h"

#include <optional>

#include <gtest/gtest.h>

#include "lib/core/random.h"

namespace spool {
namespace {

std::optional<RegionEntry> scan(const std::vector<Plane>& priority) {
  std::optional<RegionEntry> best;
  for (std::size_t l = 0; l < priority.size(); ++l) {
    for (int y = 0; y < priority[l].height(); ++y) {
      for (int x = 0; x < priority[l].width(); ++x) {
        const RegionEntry entry{static_cast<int>(l) + 1, x, y, priority[l](x, y)};
        if (entry.priority > -std::numeric_limits<double>::infinity() &&
            (!best || precedes(entry, *best))) {
          best = entry;
        }
      }
    }
  }
  return best;
}

TEST(PriorityMaxima, BestEqualsALinearScanUnderRandomRectangleUpdates) {
  const int sizes[][2] = {{1, 1}, {1, 40}, {16, 16}, {17, 33}, {300, 20}, {64, 65}, {61, 197}};
  std::uint64_t counter = 0;
  const auto random = [&](int n) {
    return static_cast<int>(mix(3, counter++) % static_cast<std::uint64_t>(n));
  };
  for (const auto& [width, height] : sizes) {
    const int levels = 4;
    std::vector<Plane> priority(levels,
                                Plane(width, height, -std::numeric_limits<double>::infinity()));
    PriorityMaxima<double> maxima(priority, 1);
    EXPECT_EQ(maxima.best(), std::nullopt);
    for (int step = 0; step < 300; ++step) {
      const int level = 1 + random(levels);
      const Rectangle all{0, 0, width, height};
      const int x = random(width), y = random(height);
      const Rectangle box = intersect({x, y, x + 1 + random(30), y + 1 + random(30)}, all);
      for (int by = box.y0; by < box.y1; ++by) {
        for (int bx = box.x0; bx < box.x1; ++bx) {
          // Few distinct values, so that ties are frequent.
          const int value = random(20);
          priority[static_cast<std::size_t>(level - 1)](bx, by) =
              value == 0 ? -std::numeric_limits<double>::infinity() : value;
        }
      }
      maxima.refresh(level, box);
      ASSERT_EQ(maxima.best(), scan(priority)) << width << "x" << height << " step " << step;
    }
  }
}

TEST(PriorityMaxima, TiesGoToTheLowerLevelThenRowThenColumn) {
  std::vector<Plane> priority(3, Plane(40, 40, 1.0));
  PriorityMaxima<double> maxima(priority, 1);
  EXPECT_EQ(maxima.best(), (RegionEntry{1, 0, 0, 1.0}));
  priority[1](35, 2) = 2.0;
  priority[1](1, 3) = 2.0;
  priority[2](0, 0) = 2.0;
  maxima.refresh(2, {0, 0, 40, 40});
  maxima.refresh(3, {0, 0, 1, 1});
  EXPECT_EQ(maxima.best(), (RegionEntry{2, 35, 2, 2.0}));
}

}  // namespace
}  // namespace spool
