// A sampler of the user's own: the counts are given, the statistics follow.
#pragma once

#include <string>

#include "lib/sampling/sampler.h"

namespace spool {

// counts: [y][x] of the pool's pieces. `name` says in errors where they came from. Error kData when
// the size differs, or a count is negative or beyond its piece's capacity. The budget does not
// limit the counts; it is logged beside what they spend.
Result<SamplingResult> sample_given_counts(const SamplePool& pool, long long budget,
                                           const CountImage& counts, const std::string& name,
                                           const SamplingContext& context);

}  // namespace spool
