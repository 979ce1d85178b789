// Samples by the deviation of a pixel's samples, denoised, after StatER [Sakai25]; from
// descriptions: what its kernel is given is public, the kernel is not.
//
// The wanted count of a piece is proportional to sqrt(mean_c s_c^2) [Neyman34], s^2 averaged over
// the neighbours that a test of variances cannot separate (lib/kernels/denoised_variance.h). A
// round hands its share out over max(0, wanted - n). `source=noisy` takes each piece's own s^2:
// pieces that no bright sample has met yet are starved, and light is lost. The criterion is
// absolute: bright places get more than a relative error asks for.
#pragma once

#include <optional>

#include "lib/kernels/pair_features.h"
#include "lib/kernels/pair_filter.h"
#include "lib/sampling/sampler.h"

namespace spool {

struct DenoisedVarianceOptions {
  std::optional<int> init_spp;  // per piece; empty: default_initial_samples()
  int rounds = 4;               // equal shares of the rest
  bool denoised = true;
  PairWindow window = {20, 10.0};
  PairFeatureOptions features;
};

const OptionTable<DenoisedVarianceOptions>& denoised_variance_option_table();

// What a round goes by, [y][x] of pieces. Errors: those of reading features.
Result<Plane> sample_deviation(const PieceStatistics& statistics, const SamplePool& pool,
                               const DenoisedVarianceOptions& options, GuardCounts& guards);

Result<SamplingResult> sample_denoised_variance(const SamplePool& pool, long long budget,
                                                const DenoisedVarianceOptions& options,
                                                const SamplingContext& context);

Sampler denoised_variance_sampler();

}  // namespace spool
