// What a step of an epoch changes, block by block: the analysis outside stays as it is.
//
// The board is cut into blocks of kBlockSide^2 pieces; for each image and each block a rectangle
// holds every entry that the step can change (and maybe more: entries computed again from the same
// inputs get the same bits). A block is small enough for its images to stay in a core's cache.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lib/core/rectangle.h"
#include "lib/sampling/multiscale/board.h"
#include "lib/sampling/multiscale/reach.h"
#include "lib/sampling/multiscale/region_sampling.h"

namespace spool {

class BlockGrid {
 public:
  static constexpr int kBlockSide = 64;

  explicit BlockGrid(const Rectangle& bounds);
  std::size_t size() const { return static_cast<std::size_t>(across_) * down_; }
  int across() const { return across_; }
  int down() const { return down_; }
  Rectangle operator[](std::size_t i) const;

  // Unites each box with the part of `r` in its block.
  void add(const Rectangle& r, std::vector<Rectangle>& boxes) const;
  std::size_t block_of(int x, int y) const {
    return static_cast<std::size_t>(y / kBlockSide) * across_ + x / kBlockSide;
  }

 private:
  Rectangle bounds_;
  int across_ = 0, down_ = 0;
};

// Rectangles per block of what one step changes.
struct StepBlocks {
  using Boxes = std::vector<Rectangle>;  // [block]

  Boxes changed;                   // pieces that were sampled
  std::vector<Boxes> coarse;       // f_k at [k]
  std::vector<Boxes> detail;       // d_k at [k]
  std::vector<Boxes> variance;     // V_k at [k], k >= 1
  std::vector<Boxes> attenuation;  // A_k at [k]
  std::vector<Boxes> priority;     // P_k at [k], k >= 1

  StepBlocks(const Board& board, const BlockGrid& grid, const StepReach& reach,
             std::span<const Pick> picks, const MultiscaleOptions& options);
};

}  // namespace spool
