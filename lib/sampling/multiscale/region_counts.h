// Per region: how many samples are fresh and how many pieces can still be sampled.
#pragma once

#include <algorithm>

#include "lib/core/image.h"
#include "lib/core/rectangle.h"
#include "lib/sampling/multiscale/board.h"

namespace spool {

// For the regions R_k of the entries in `box`, clipped to the board's area. The board must outlive
// it and not change meanwhile.
class RegionCounts {
 public:
  RegionCounts(const Board& board, int level, const Rectangle& box, bool with_fresh = true);

  // Samples taken in this step; only `with_fresh`.
  int fresh(int x, int y) const { return fresh_(x - box_.x0, y - box_.y0); }
  const std::int32_t* fresh_row(int x, int y) const { return &fresh_(x - box_.x0, y - box_.y0); }
  int largest_fresh() const;
  bool all_open() const { return closed_.empty(); }
  // Pieces that were not saturated before this step.
  int open(int x, int y) const {
    const int closed = closed_.empty() ? 0 : closed_(x - box_.x0, y - box_.y0);
    return pieces(x, y) - closed;
  }

 private:
  int pieces(int x, int y) const {
    const int w = std::min(x + after_ + 1, area_.x1) - std::max(x - before_, area_.x0);
    const int h = std::min(y + after_ + 1, area_.y1) - std::max(y - before_, area_.y0);
    return w * h;
  }

  Rectangle box_, area_;
  int before_ = 0, after_ = 0;
  CountImage fresh_;
  CountImage closed_;  // empty when no piece of the regions is saturated
};

}  // namespace spool
