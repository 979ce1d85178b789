// The priority of every region (eqs 5 and 6), in double.
//
//   V_k = (1/N) sum of C^2 over R_k, N = pieces of R_k inside the window      [LiuZheng (6)]
//   P_k = (V_k + D_k) A_k,  D_k = d_{k-1}^2                       [LiuZheng (5)]
//
// -infinity where every piece of the region is saturated. With several analysed scalars, the
// largest. Slow twin: tests/reference/multiscale_reference.h.
#pragma once

#include "lib/core/guards.h"
#include "lib/core/rectangle.h"
#include "lib/sampling/multiscale/board.h"

namespace spool {

// Recomputes V_k on `box`.
void update_variance_term(ScalarAnalysis<double>& scalar, int k, const Rectangle& box);

// Recomputes P_k on the part of `box` that lies in the board's area, as if nothing were saturated.
void compute_priority(ExactBoard& board, int k, const Rectangle& box,
                      const MultiscaleOptions& options, GuardCounts& guards);
// compute_priority, then closes regions.
void update_priority(ExactBoard& board, int k, const Rectangle& box,
                     const MultiscaleOptions& options, GuardCounts& guards);

}  // namespace spool
