// Samples where a feature-guided filter expects the largest relative risk [LiWuChuang12].
//
//   density = max(0, SURE + v) / (F^2 + 0.01) / (1 + n)
//
// SURE and F are those of the best scale of each piece (lib/kernels/cross_bilateral.h). The budget
// left after the first samples goes in equal rounds, apportioned over the density, no piece beyond
// its pool. SURE assumes Gaussian means: with few samples and heavy tails it is unreliable.
#pragma once

#include <optional>

#include "lib/kernels/cross_bilateral.h"
#include "lib/sampling/sampler.h"

namespace spool {

struct CrossBilateralSamplingOptions {
  std::optional<int> init_spp;  // per piece; empty: default_initial_samples()
  int iterations = 4;
  CrossBilateralOptions filter;

  CrossBilateralSamplingOptions() { filter.risk_scale = 4.0; }
};

// Errors: those of cross_bilateral().
Result<SamplingResult> sample_cross_bilateral(const SamplePool& pool, long long budget,
                                              const CrossBilateralSamplingOptions& options,
                                              const SamplingContext& context);

// What a round is apportioned over.
Result<Plane> cross_bilateral_density(const PieceStatistics& statistics, const SamplePool& pool,
                                      const CrossBilateralOptions& options, GuardCounts& guards);

Sampler cross_bilateral_sampler();

}  // namespace spool
