// The regions of one epoch: the best entries in the order of `precedes`, each skipped when its
// region overlaps one already taken.
//
// Entries are gathered and sorted in batches of falling priority, so that the whole is never
// sorted; where the batches are cut does not change the order.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/core/image.h"
#include "lib/sampling/multiscale/board.h"
#include "lib/sampling/multiscale/step_blocks.h"
#include "lib/sampling/region_queue.h"

namespace spool {

// The largest priority of each block and level, or more: closing a region need not lower it.
class PriorityMaxima {
 public:
  PriorityMaxima(const BlockGrid& grid, const Board& board);
  // P_level changed inside block b. Several threads may refresh different blocks.
  void refresh(const Board& board, int level, std::size_t b);

  const BlockGrid& grid() const { return grid_; }
  double operator()(std::size_t level_index, std::size_t b) const {
    return maxima_[level_index * grid_.size() + b];
  }

 private:
  BlockGrid grid_;
  std::vector<double> maxima_;
};

class GreedyOrder {
 public:
  // Only priorities > `above` count. `expected`: about how many entries will be asked for. The
  // board and the maxima must outlive this and keep their values.
  GreedyOrder(const Board& board, const PriorityMaxima& maxima, double above, std::size_t expected);

  // The next entry whose region is free; level 0 when there is none.
  RegionEntry next();
  // Marks the region of an entry as taken.
  void take(const RegionEntry& entry);

 private:
  bool is_free(const RegionEntry& entry) const;
  bool gather();  // fills batch_ with the free entries of the next range of priorities

  const Board& board_;
  const PriorityMaxima& maxima_;
  double above_;
  std::size_t expected_;
  std::vector<double> sampled_;  // some priorities, falling: where to cut
  std::size_t sampled_used_ = 0;
  double upper_;  // entries with priority >= upper_ were gathered
  std::vector<RegionEntry> batch_;
  std::size_t batch_used_ = 0;
  std::size_t entries_ = 0;
  Image<std::uint8_t> taken_;
};

}  // namespace spool
