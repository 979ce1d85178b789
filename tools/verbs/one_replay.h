// One run of a sampler and one of a filter on a pool: what `spool replay` and `spool reconstruct`
// do, without files. A sampler with a filter in its loop has the filter of the image there, as in
// an evaluation.
#pragma once

#include <functional>

#include "lib/core/footprint.h"
#include "lib/filters/filter.h"
#include "lib/methods/method_text.h"
#include "lib/pool/sample_pool.h"
#include "lib/sampling/sampler.h"

namespace spool::tools {

// `filter.run` may be empty where no image is wanted and the sampler has none in its loop.
struct ReplayMethods {
  MethodChoice sampler_choice, filter_choice;
  ReadySampler sampler;
  ReadyFilter filter;
};

// `cancelled` is asked now and then and may be null; what comes of a cancelled run is of no use.
Result<SamplingResult> sample_once(const ReplayMethods& methods, const SamplePool& pool, double spp,
                                   const std::function<bool()>* cancelled = nullptr);

Result<Reconstruction> filter_once(const ReplayMethods& methods, const Selection& selection,
                                   const SamplePool& pool, Footprints* footprints = nullptr);

}  // namespace spool::tools
