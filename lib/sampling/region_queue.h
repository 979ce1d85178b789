// The largest entry of K dense priority images that change by whole rectangles: a tree of maxima.
//
// Two levels above each image: maxima of 16 x 16 entries, and of 16 x 16 of those. A changed
// rectangle rewrites the blocks that it touches; a query scans the top. Larger priority first; ties
// go to the lower level, then lower y, then lower x.
// Slow twin: a linear scan, in tests/sampling.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "lib/core/image.h"
#include "lib/core/rectangle.h"

namespace spool {

struct RegionEntry {
  int level = 0;  // 1 .. K
  int x = 0, y = 0;
  double priority = -std::numeric_limits<double>::infinity();
  friend bool operator==(const RegionEntry&, const RegionEntry&) = default;
};

// The order in which entries leave the queue.
inline bool precedes(const RegionEntry& a, const RegionEntry& b) {
  if (a.priority != b.priority) return a.priority > b.priority;
  if (a.level != b.level) return a.level < b.level;
  if (a.y != b.y) return a.y < b.y;
  return a.x < b.x;
}

class RegionQueue {
 public:
  // Of `levels` images, all of one size; everything starts at -infinity.
  RegionQueue(int width, int height, int levels);

  // priority[level - 1] was rewritten inside `changed`.
  void refresh(std::span<const Plane> priority, int level, const Rectangle& changed);

  // Priority -infinity when nothing is left.
  RegionEntry best() const;

 private:
  struct Maximum {
    double priority = -std::numeric_limits<double>::infinity();
    std::uint32_t index = std::numeric_limits<std::uint32_t>::max();  // y * width + x
  };
  static bool larger(const Maximum& a, const Maximum& b) {
    return a.priority != b.priority ? a.priority > b.priority : a.index < b.index;
  }

  int width_ = 0, height_ = 0;
  std::vector<Image<Maximum>> blocks_;   // per level
  std::vector<Image<Maximum>> regions_;  // per level, of 16 x 16 blocks
};

}  // namespace spool
