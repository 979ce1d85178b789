// The loop that spends a budget on a board, in its two modes.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lib/core/guards.h"
#include "lib/sampling/multiscale/board.h"
#include "lib/sampling/multiscale/region_sampling.h"

namespace spool {

struct LoopLog {
  long long spent = 0;
  long long uniform_remainder = 0;           // of `spent`: nothing had a priority
  std::vector<long long> samples_of_level;   // by the level of the pop, 0 .. K; 0: uniform
  std::vector<CountImage> level_of_samples;  // [level][y][x] of the window, if asked for
  GuardCounts guards;
};

struct LoopControl {
  std::uint64_t seed = 0;          // of this board
  bool keep_level_images = false;  // fill level_of_samples
  bool keep_details = false;       // leave d_0 .. on the board, which the loop may do without
  std::function<bool(long long)> report;  // samples spent since the last call; false: stop
};

// Pops one region at a time and recomputes exactly what it changed.
LoopLog run_exact(Board& board, Samples& samples, const SamplePool& pool, long long budget,
                  const MultiscaleOptions& options, const LoopControl& control);

// Takes many regions that do not overlap, then analyses the whole board, `epochs` times.
LoopLog run_epochs(Board& board, Samples& samples, const SamplePool& pool, long long budget,
                   const MultiscaleOptions& options, const LoopControl& control);

// Spends what is left when no region has a priority: least-sampled pieces first.
void spend_remainder(Board& board, Samples& samples, const SamplePool& pool, long long left,
                     const MultiscaleOptions& options, const LoopControl& control, LoopLog& log);

LoopLog make_loop_log(const Board& board, const MultiscaleOptions& options,
                      const LoopControl& control);
// Counts the picks of one pop.
void record_pop(LoopLog& log, int level, std::span<const Pick> picks);

}  // namespace spool
