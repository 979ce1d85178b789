// The multiscale sampler [LiuZheng]: samples go, region by region, where contrast and lost detail
// are large and the coarse image still changes. docs/method.md, sections 1-4.
#pragma once

#include "lib/sampling/multiscale/options.h"
#include "lib/sampling/sampler.h"

namespace spool {

// Errors: kUsage when `tile` does not fit K; kData when cancelled.
Result<SamplingResult> sample_multiscale(const SamplePool& pool, long long budget,
                                         const MultiscaleOptions& options,
                                         const SamplingContext& context);

Sampler multiscale_sampler();

}  // namespace spool
