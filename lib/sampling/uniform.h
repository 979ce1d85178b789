// The uniform sampler: the same number of samples in every piece.
//
// A budget that is not a whole number per piece gives one sample more to pieces chosen by a hash of
// their index; a piece that runs out hands its share on to the others.
#pragma once

#include <cstdint>
#include <limits>

#include "lib/core/rectangle.h"
#include "lib/sampling/sampler.h"

namespace spool {

struct UniformOptions {};

Result<SamplingResult> sample_uniform(const SamplePool& pool, long long budget,
                                      const UniformOptions& options,
                                      const SamplingContext& context);

// The counts of the pieces in `area` after `budget` more samples went to the least-sampled ones,
// ties by a hash of seed and index; no piece beyond its capacity in the pool or beyond `limit`.
// Less is given only when every piece is full. n: [y][x] of the whole pool, read inside `area`
// only. Result: [y][x] of `area`.
CountImage raise_least_sampled(const CountImage& n, const SamplePool& pool, const Rectangle& area,
                               long long budget, std::uint64_t seed,
                               int limit = std::numeric_limits<int>::max());

Sampler uniform_sampler();

}  // namespace spool
