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

enum class ExposureMode { kNormalise, kNone };

struct UniformOptions {
  ExposureMode exposure = ExposureMode::kNormalise;
  double key = 1.0;  // mean of the exposed analysis signal
};

const OptionTable<UniformOptions>& uniform_option_table();

Result<SamplingResult> sample_uniform(const SamplePool& pool, long long budget,
                                      const UniformOptions& options,
                                      const SamplingContext& context);

// Raises `n` inside `area` by `budget` samples, least-sampled pieces first, ties by a hash of seed
// and index; no piece beyond its capacity in the pool or beyond `limit`. Returns how many were
// given, less than `budget` only when every piece is full.
long long raise_least_sampled(CountImage& n, const SamplePool& pool, const Rectangle& area,
                              long long budget, std::uint64_t seed,
                              int limit = std::numeric_limits<int>::max());

}  // namespace spool
