// The largest entry of dense priority images that change by whole rectangles.
//
// Kept above each image: the maximum of every row of every block of 64 x 64 entries, and the first
// of the largest entries of every block. A changed rectangle rewrites what it touches. Larger
// priority first; ties go to the lower level, then lower y, then lower x: a total order, so that no
// result depends on how it is found. Slow twin: a linear scan, in tests/sampling.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "lib/core/image.h"
#include "lib/core/rectangle.h"

namespace spool {

struct RegionEntry {
  int level = 0;
  int x = 0, y = 0;
  double priority = -std::numeric_limits<double>::infinity();
  friend bool operator==(const RegionEntry&, const RegionEntry&) = default;
};

// The order in which entries are taken.
inline bool precedes(const RegionEntry& a, const RegionEntry& b) {
  if (a.priority != b.priority) return a.priority > b.priority;
  if (a.level != b.level) return a.level < b.level;
  if (a.y != b.y) return a.y < b.y;
  return a.x < b.x;
}

inline constexpr int kMaximaSide = 64;  // of a block

// T: double or float, the type of the images.
template <class T>
class PriorityMaxima {
 public:
  // Of images[level - first_level], which must outlive this; each may have its own size.
  PriorityMaxima(const std::vector<Image<T>>& images, int first_level);

  // The image of `level` was rewritten inside `changed`. Several threads may refresh different
  // blocks.
  void refresh(int level, const Rectangle& changed);

  // The first entry; none when every priority is -infinity.
  std::optional<RegionEntry> best() const;

  const std::vector<Image<T>>& images() const { return *images_; }
  int first_level() const { return first_level_; }
  // The largest priority of row y of a column of blocks.
  T of_row(std::size_t image, int y, int block_column) const {
    return rows_[image](block_column, y);
  }

 private:
  void refresh_block(std::size_t image, int bx, int by, const Rectangle& changed);

  const std::vector<Image<T>>* images_;
  int first_level_;
  std::vector<Image<T>> rows_;              // [image][y][column of blocks]
  std::vector<Image<RegionEntry>> blocks_;  // [image][row of blocks][column of blocks]
};

}  // namespace spool
