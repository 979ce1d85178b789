// The regions of one epoch: the best entries in the order of `precedes`, each skipped when its
// region overlaps one already taken.
//
// Entries are gathered in batches of falling priority, and a batch is laid into buckets of which
// each is sorted when its turn comes, so that the whole is never sorted; where batches and buckets
// are cut does not change the order.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/core/image.h"
#include "lib/sampling/multiscale/board.h"
#include "lib/sampling/multiscale/step_blocks.h"
#include "lib/sampling/region_queue.h"

namespace spool {

// The largest priority of each row of each block and level, or more: closing a region need not
// lower it.
class PriorityMaxima {
 public:
  PriorityMaxima(const BlockGrid& grid, const Board& board);
  // P_level changed in rows y0 .. y1-1 of block b. Several threads may refresh different blocks.
  void refresh(const Board& board, int level, std::size_t b, int y0, int y1);

  const BlockGrid& grid() const { return grid_; }
  double operator()(std::size_t level_index, int y, int block_column) const {
    return maxima_[level_index](block_column, y);
  }

 private:
  BlockGrid grid_;
  std::vector<Plane> maxima_;  // [level - 1][y][column of blocks]
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
  // An entry in 16 bytes: the smaller place precedes among equal priorities.
  struct Candidate {
    double priority;
    std::uint64_t place;
  };

  bool is_free(const RegionEntry& entry) const;
  bool gather();       // fills batch_ with the entries of the next range of priorities
  void lay_out();      // batch_ into buckets of falling priority
  bool next_bucket();  // sorts the free entries of the next bucket
  void gather_rows(int row, double lower, std::vector<Candidate>& found) const;

  const Board& board_;
  const PriorityMaxima& maxima_;
  double above_;
  std::size_t expected_;
  std::vector<double> sampled_;  // some priorities, falling: where to cut
  std::size_t sampled_used_ = 0;
  double upper_;  // entries with priority > upper_ were gathered
  std::size_t entries_ = 0;
  std::vector<std::vector<Candidate>> of_row_;  // [row of blocks]
  std::vector<Candidate> batch_;
  std::vector<std::size_t> bucket_end_;
  std::size_t bucket_ = 0;                  // the next one
  std::size_t used_ = 0, bucket_last_ = 0;  // of the present bucket: batch_[used_, bucket_last_)
  Image<std::uint8_t> taken_;
};

}  // namespace spool
