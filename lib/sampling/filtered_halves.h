// Samples where a filter is unsure of itself (filter_disagreement.h), by all samples taken.
//
// The wanted count of a pixel is proportional to sqrt(e), the smoothed relative difference of the
// filter on even and on odd samples; a round hands its share out over max(0, wanted - n). The
// filter comes in as SamplingContext::filter. Samples that decide are averaged too, so rare light
// is lost; cross_halves.h loses none.
#pragma once

#include "lib/sampling/filter_disagreement.h"

namespace spool {

struct FilteredHalvesOptions {
  double start =
      0.25;  // share of the budget that is spent uniformly first, at least 2 samples each
  int rounds = 4;
  double blur = 2.0;  // sigma of the smoothing of e, pixels
  std::string filter = kDefaultLoopFilter;
};

// Errors: kUsage without a filter; whatever the filter returns.
Result<SamplingResult> sample_filtered_halves(const SamplePool& pool, long long budget,
                                              const FilteredHalvesOptions& options,
                                              const SamplingContext& context);

Sampler filtered_halves_sampler();

}  // namespace spool
