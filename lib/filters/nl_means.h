// Non-local means between two halves of the samples [RousselleKnausZwicker12].
//
// Halves A and B hold the even and the odd samples of each piece. Weights come from one half and
// filter the other (lib/kernels/patch_filter.h); the result is the mean of F_A and F_B by sample
// counts. A half without samples is filled from its neighbours.
// Slow twin: tests/reference/nl_means_reference.h.
#pragma once

#include "lib/filters/filter.h"
#include "lib/kernels/patch_filter.h"
#include "lib/kernels/sample_half.h"

namespace spool {

struct NlMeansOptions {
  PatchFilterOptions filter{.window = 10, .patch = 3, .kappa = 0.35, .alpha = 1.0};
  HalfVariance var_mode = HalfVariance::kBoth;
};

Filter nl_means_filter();

}  // namespace spool
