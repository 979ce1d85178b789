// Slow twin of lib/filters/directional/lone_sizes.h, by counting.
#pragma once

#include <algorithm>

#include "lib/core/image.h"

namespace spool::reference {

// Pieces of the 5 x 5 around (x, y) for which `holds`.
template <class Holds>
int count_around(int width, int height, int x, int y, Holds holds) {
  int count = 0;
  for (int v = y - 2; v <= y + 2; ++v) {
    for (int u = x - 2; u <= x + 2; ++u)
      count += holds(std::clamp(u, 0, width - 1), std::clamp(v, 0, height - 1)) ? 1 : 0;
  }
  return count;
}

inline CountImage without_lone_sizes(const CountImage& level, const Plane& kept,
                                     const Plane& mean) {
  const int width = level.width(), height = level.height();
  CountImage result = level;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      // Brighter than four times the median: than four times as many as 13 of the 25.
      const int darker = count_around(width, height, x, y,
                                      [&](int u, int v) { return mean(x, y) > 4.0 * mean(u, v); });
      if (!kept.empty() && kept(x, y) > 0.0 && darker >= 13) continue;
      // The smallest size from the own one on that five pieces do not exceed.
      while (count_around(width, height, x, y,
                          [&](int u, int v) { return level(u, v) <= result(x, y); }) < 5)
        ++result(x, y);
    }
  }
  return result;
}

}  // namespace spool::reference
