// Samples where NL-means between two halves of the samples disagrees with itself
// [RousselleKnausZwicker12].
//
// Halves A and B (even and odd samples) are filtered with weights from each other
// (lib/kernels/patch_filter.h):
//
//   error = sum over both halves of mean_c 2 (F_A - F_B)^2 / (0.1 + F^2) / N,  F of that half
//
// with N the half's sample count filtered by the same weights; blurred with a Gaussian of 0.8
// pieces. An iteration apportions its share over the error, no pixel more than `spp` in one
// iteration. Slow twin: tests/reference/nl_means_reference.h.
#pragma once

#include <array>
#include <optional>

#include "lib/kernels/patch_filter.h"
#include "lib/kernels/sample_half.h"
#include "lib/sampling/sampler.h"

namespace spool {

struct NlMeansSamplingOptions {
  std::optional<int> init_spp;  // per piece; empty: default_initial_samples(), at least 2
  int iterations = 8;
  PatchFilterOptions filter{7, 3, 0.45, 0.5};
  HalfVariance var_mode = HalfVariance::kBoth;
};

Result<SamplingResult> sample_nl_means(const SamplePool& pool, long long budget,
                                       const NlMeansSamplingOptions& options,
                                       const SamplingContext& context);

// The halves of a pool of which nothing is taken yet.
std::array<HalfSums, 2> empty_halves(const SamplePool& pool, const NlMeansSamplingOptions& options);

// The error of every piece before the blur; the halves have all samples of `statistics`.
Result<Plane> nl_means_error(const std::array<HalfSums, 2>& halves,
                             const PieceStatistics& statistics,
                             const NlMeansSamplingOptions& options, GuardCounts& guards);

Sampler nl_means_sampler();

}  // namespace spool
