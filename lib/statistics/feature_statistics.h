// Means of recorded features - albedo, normal, depth - over the samples taken, and the variances of
// those means, read from the recording when asked for.
//
// As everywhere, only samples behind the cursor count. A value that is not finite or beyond 1e15
// counts as 0 (guard). A piece without samples takes its neighbours' values. Depth is brought to
// [-1, 1] by its largest mean; the others stay in their units. Slow twin:
// tests/reference/cross_bilateral_reference.h.
#pragma once

#include <vector>

#include "lib/core/error.h"
#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/pool/sample_pool.h"

namespace spool {

struct FeatureStatistics {
  FeatureLayer layer;
  std::vector<Plane> mean;      // [channel][y][x] of pieces
  std::vector<Plane> variance;  // [channel][y][x] of `mean`
};

inline constexpr double kLargestFeatureValue = 1e15;  // beyond it is no feature

// Of one layer of the recording, every sample clipped to [-largest, largest]. Errors: those of
// reading.
Result<FeatureStatistics> feature_statistics(const SamplePool& pool, const CountImage& n,
                                             const FeatureLayer& layer, GuardCounts& guards,
                                             double largest = kLargestFeatureValue);
// One entry per layer of the recording, in its order; none where none were recorded.
Result<std::vector<FeatureStatistics>> feature_statistics(const SamplePool& pool,
                                                          const CountImage& n, GuardCounts& guards);

}  // namespace spool
