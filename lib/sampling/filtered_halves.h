// Samples where the filter of the final image is unsure of itself.
//
// Each pixel's samples so far are split in halves A, B (even and odd ones); both are filtered with
// the filter F that will make the image:
//
//   e = mean_c (F(A) - F(B))^2 / (F^2 + 0.01),  F = (F(A) + F(B)) / 2,  smoothed with a Gaussian
//
// The wanted count of a pixel is proportional to sqrt(e); a round hands its share out over
// max(0, wanted - n). F comes in as SamplingContext::filter. Radiance is exposed to mean 1.
#pragma once

#include "lib/sampling/sampler.h"

namespace spool {

struct FilteredHalvesOptions {
  double start =
      0.25;  // share of the budget that is spent uniformly first, at least 2 samples each
  int rounds = 4;
  double blur = 2.0;  // sigma of the smoothing of e, pixels
};

const OptionTable<FilteredHalvesOptions>& filtered_halves_option_table();

// Errors: kUsage without a filter; whatever the filter returns.
Result<SamplingResult> sample_filtered_halves(const SamplePool& pool, long long budget,
                                              const FilteredHalvesOptions& options,
                                              const SamplingContext& context);

// The statistics of every second sample taken (parity 0: even), with the same analysis signal.
// `half_pool` is pool.half(parity).
PieceStatistics half_statistics(const PieceStatistics& statistics, const SamplePool& half_pool,
                                int parity);

// Samples to take in a round: `share` over the pieces that have fewer than they are worth, where
// the worth of a piece is proportional to `weight` and sums to all samples so far and the share.
CountImage hand_out_deficits(const Plane& weight, const CountImage& n, const SamplePool& pool,
                             long long share);

// A value per pixel, split evenly over its pieces.
Plane pixels_to_pieces(const Plane& pixels, int pieces_per_side);

Sampler filtered_halves_sampler();

}  // namespace spool
