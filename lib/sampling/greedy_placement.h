// Where greedy error minimisation puts the samples of an iteration (lib/sampling/greedy_error.h).
#pragma once

#include <cstdint>

#include "lib/pool/sample_pool.h"
#include "lib/sampling/greedy_error_map.h"

namespace spool {

// `share` samples, `per_pixel` for each of the pixels with the largest errors until it is spent.
CountImage hand_out_greedily(const GreedyErrorMap& map, const PieceStatistics& statistics,
                             const SamplePool& pool, long long share, long long per_pixel,
                             std::uint64_t seed, const GreedyErrorOptions& options);

}  // namespace spool
