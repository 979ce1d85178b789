#include "lib/statistics/window_sums.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lib/core/parallel.h"
#include "lib/core/random.h"

namespace spool {
namespace {

Plane noise(int width, int height) {
  Plane plane(width, height);
  for (std::size_t i = 0; i < plane.size(); ++i)
    plane[i] = std::exp2(20.0 * unit_double(mix(3, i)));
  return plane;
}

double slow_sum(const Plane& in, int x, int y, int radius) {
  long double sum = 0;
  for (int py = std::max(y - radius, 0); py < in.height() && py <= y + radius; ++py) {
    for (int px = std::max(x - radius, 0); px < in.width() && px <= x + radius; ++px)
      sum += in(px, py);
  }
  return static_cast<double>(sum);
}

TEST(WindowSums, EqualTheSumsInPlainLoops) {
  for (const auto& [width, height] :
       {std::pair{1, 1}, {1, 9}, {9, 1}, {2, 3}, {17, 13}, {31, 64}}) {
    const Plane in = noise(width, height);
    for (const int radius : {0, 1, 2, 3, 4, 8, 15, 16, 40, 1000}) {
      const Plane sums = window_sums(in, radius);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          const double slow = slow_sum(in, x, y, radius);
          ASSERT_NEAR(sums(x, y), slow, 1e-14 * slow) << width << "x" << height << " " << radius;
        }
      }
    }
  }
}

TEST(WindowSums, FireflyLeavesNoTraceOutsideItsWindows) {
  Plane in(64, 64, 1.0);
  in(30, 20) = 1e300;
  const Plane sums = window_sums(in, 4);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      if (std::abs(x - 30) > 4 || std::abs(y - 20) > 4) {
        ASSERT_EQ(sums(x, y), slow_sum(in, x, y, 4));
      }
    }
  }
}

TEST(WindowSums, BitsDoNotDependOnThreads) {
  const Plane in = noise(67, 45);
  const Plane once = [&] {
    const ThreadLimit one(1);
    return window_sums(in, 6);
  }();
  for (const int threads : {2, 3, 8}) {
    const ThreadLimit limit(threads);
    EXPECT_EQ(window_sums(in, 6), once);
  }
}

}  // namespace
}  // namespace spool
