// The analysis of a whole board before its first step, equation after equation.
#pragma once

#include "lib/core/guards.h"
#include "lib/sampling/multiscale/board.h"

namespace spool {

// From loaded pieces: f and d (eqs 1-4), V (eq 6), A at its start (eq 7), P (eq 5).
void analyse(Board& board, const MultiscaleOptions& options, GuardCounts& guards);

}  // namespace spool
