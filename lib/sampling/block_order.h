// Blocks of several levels in the order of their priorities, as many as are asked for.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "lib/core/image.h"
#include "lib/sampling/region_queue.h"

namespace spool {

// Blocks of positive priority in the order of `precedes`; entry.x, entry.y count blocks. Gathered
// and sorted in batches of falling priority: where they are cut does not change the order.
class BlockOrder {
 public:
  // priorities: [level][y][x]. `expected`: about how many blocks will be asked for.
  BlockOrder(std::vector<Plane> priorities, std::size_t expected);

  // Level -1 when there is none.
  RegionEntry next();

 private:
  void gather();

  std::vector<Plane> priorities_;
  std::size_t expected_, blocks_ = 0;
  std::vector<double> sampled_;  // some priorities, falling: where to cut
  std::size_t sampled_used_ = 0;
  double upper_ = std::numeric_limits<double>::infinity();  // larger ones were gathered
  std::vector<RegionEntry> batch_;
  std::size_t used_ = 0;
};

}  // namespace spool
