// Oracle: samples in proportion to the standard deviation of each piece's whole recorded pool
// [Neyman34]. It knows what no sampler can know; its raw error is a lower bound for the others.
#pragma once

#include "lib/sampling/sampler.h"

namespace spool {

struct NeymanOptions {
  int init_spp = 1;  // every piece, whatever its deviation
};

const OptionTable<NeymanOptions>& neyman_option_table();

// Deviation: sqrt of the channels' mean variance over all recorded samples, the held-out ones too.
Result<SamplingResult> sample_neyman(const SamplePool& pool, long long budget,
                                     const NeymanOptions& options, const SamplingContext& context);

Sampler neyman_sampler();

}  // namespace spool
