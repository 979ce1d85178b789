// The analysis of a whole board before its first step.
#pragma once

#include "lib/core/guards.h"
#include "lib/sampling/multiscale/board.h"

namespace spool {

// From loaded pieces: f and d (eqs 1-4), V (eq 6), A at its start (eq 7), P (eq 5).
void analyse(ExactBoard& board, const MultiscaleOptions& options, bool all_images,
             GuardCounts& guards);
// The same in float. d and V are kept, now and in every later step, if `all_images` are wanted; the
// other board always has them.
void analyse(EpochBoard& board, const MultiscaleOptions& options, bool all_images,
             GuardCounts& guards);

}  // namespace spool
