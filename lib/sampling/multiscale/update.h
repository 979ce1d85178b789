// What a step does to a board: the one interface of update=exact and update=epoch.
#pragma once

#include <vector>

#include "lib/core/guards.h"
#include "lib/sampling/multiscale/board.h"
#include "lib/sampling/multiscale/board_log.h"

namespace spool {

// Of a board that is analysed and outlives it. In a step: choose(), take_picks(), update_images(),
// end_step(), update_priorities().
class Update {
 public:
  virtual ~Update() = default;
  // Samples of the regions of largest priority, none of which overlap, marked in board.fresh; at
  // most `left`. Empty when no region has a priority.
  virtual const std::vector<Pick>& choose(const Samples& samples, const SamplePool& pool,
                                          long long left, BoardLog& log) = 0;
  // What the samples changed of f, d (eqs 1-4), V (eq 6) and A (eqs 7, 8).
  virtual void update_images(GuardCounts& guards) = 0;
  // What changed of P (eq 5), and no priority where every piece of a region has run out.
  virtual void update_priorities(GuardCounts& guards) = 0;
};

}  // namespace spool
