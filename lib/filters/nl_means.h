// Non-local means between two halves of the samples [RousselleKnausZwicker12].
//
// Halves A and B hold the even and the odd samples of each piece. Weights come from one half and
// filter the other (lib/kernels/patch_filter.h); the result is the mean of F_A and F_B by sample
// counts. A half without samples is filled from its neighbours.
// Slow twin: tests/reference/nl_means_reference.h.
#pragma once

#include "lib/filters/filter.h"
#include "lib/kernels/patch_filter.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {

struct NlMeansOptions {
  PatchFilterOptions filter;
  // A half of few samples often has variance 0 by chance, and distances are divided by it.
  VarianceMode var_mode = VarianceMode::kPooled;
};

OptionTable<NlMeansOptions> nl_means_option_table();

Result<Reconstruction> reconstruct_nl_means(const Selection& selection, const SamplePool& pool,
                                            const NlMeansOptions& options,
                                            const FilterContext& context);

Filter nl_means_filter();

}  // namespace spool
