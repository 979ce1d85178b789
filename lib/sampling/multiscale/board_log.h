// What happened on a board while its budget was spent.
#pragma once

#include <span>
#include <vector>

#include "lib/core/guards.h"
#include "lib/sampling/multiscale/board.h"
#include "lib/sampling/multiscale/region_sampling.h"

namespace spool {

struct BoardLog {
  long long spent = 0;
  long long uniform_remainder = 0;           // of `spent`: nothing had a priority
  std::vector<long long> samples_of_level;   // by the level of the region, 0 .. K; 0: uniform
  std::vector<CountImage> level_of_samples;  // [level][y][x] of the window, if asked for
  GuardCounts guards;
};

BoardLog make_board_log(const Board& board, const MultiscaleOptions& options,
                        bool keep_level_images);
// Counts the samples of one region, but for the images.
void record_samples(BoardLog& log, int level, long long count);
// Counts the picks of one region.
void record_region(BoardLog& log, int level, std::span<const Pick> picks);

}  // namespace spool
