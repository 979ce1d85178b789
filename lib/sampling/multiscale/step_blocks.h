// What a step of an epoch changes, block by block: the analysis outside stays as it is.
//
// The board is cut into blocks of kBlockSide^2 pieces; a block is small enough for its images to
// stay in a core's cache, and large enough for what it reads around it to be little beside it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lib/core/rectangle.h"
#include "lib/sampling/multiscale/region_sampling.h"

namespace spool {

class BlockGrid {
 public:
  static constexpr int kBlockSide = 128;  // whole blocks of PriorityMaxima

  explicit BlockGrid(const Rectangle& bounds);
  std::size_t size() const { return static_cast<std::size_t>(across_) * down_; }
  Rectangle operator[](std::size_t i) const;

  // Per block what lies within `reach` of a pick, or more: the entries that the step may change.
  std::vector<Rectangle> changed(std::span<const Pick> picks, int reach) const;

 private:
  std::size_t block_of(int x, int y) const {
    return static_cast<std::size_t>(y / kBlockSide) * across_ + x / kBlockSide;
  }
  // Unites each box with the part of `r` in its block.
  void add(const Rectangle& r, std::vector<Rectangle>& boxes) const;

  Rectangle bounds_;
  int across_ = 0, down_ = 0;
};

}  // namespace spool
