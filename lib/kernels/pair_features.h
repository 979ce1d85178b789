// Recorded albedo and normal as pair_filter.h takes them: over sqrt(2) times their scale, and with
// the variance of their noise where that is to be taken off.
#pragma once

#include "lib/core/error.h"
#include "lib/core/guards.h"
#include "lib/kernels/pair_filter.h"
#include "lib/pool/sample_pool.h"

namespace spool {

struct PairFeatureOptions {
  double sigma_albedo = 0.02, sigma_normal = 0.1;
  bool noise = false;  // distances less their noise
};

// Half of each variance is that of its 3 x 3 neighbourhood. Errors: those of reading.
Result<PairFeatures> pair_features(const SamplePool& pool, const CountImage& n,
                                   const PairFeatureOptions& options, GuardCounts& guards);

// `plane` times `factor`.
Image<float> to_float(const Plane& plane, double factor = 1.0);

}  // namespace spool
