// Recorded features, and the same cleaned by themselves: each piece's mean becomes the value of a
// line through the pieces whose features look alike (feature_fit.h), which takes the noise of lens
// and motion off and leaves edges and ramps.
//
// Channels are those of albedo, normal and depth, as many as were recorded; none is allowed. Values
// are clipped to [-4, 4], depth is divided by its largest mean. Albedos whose sum of squares over
// their sum is below 0.3 are brought up to that, so that constants in units of features find the
// textures of dark surfaces. A piece without samples has its neighbours' features. Slow twins:
// tests/reference/feature_fit_reference.h, twin_guides_reference.h.
#pragma once

#include <vector>

#include "lib/core/error.h"
#include "lib/core/guards.h"
#include "lib/filters/twin_guides/feature_blend.h"
#include "lib/pool/sample_pool.h"

namespace spool {

inline constexpr std::size_t kMostFeatureChannels = 7;

struct CleanFeatures {
  std::vector<Image<float>> raw;  // [channel][y][x] means over the samples taken
  FeatureImages clean;            // and variances of the cleaned means
};

// Errors: those of reading; kData when a recording has more channels than kMostFeatureChannels.
Result<CleanFeatures> clean_features(const SamplePool& pool, const CountImage& n,
                                     GuardCounts& guards);

// The same for features at hand; `raw.variance` is blurred already.
CleanFeatures clean_features(FeatureImages raw);

}  // namespace spool
