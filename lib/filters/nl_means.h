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

OptionTable<NlMeansOptions> nl_means_option_table();
// robust; paper: kappa = 0.45, and the variance of a half by its own samples.
const Presets<NlMeansOptions>& nl_means_presets();

Result<Reconstruction> reconstruct_nl_means(const Selection& selection, const SamplePool& pool,
                                            const NlMeansOptions& options,
                                            const FilterContext& context);

Filter nl_means_filter();

}  // namespace spool
