// Adaptive wavelet sampling after [OverbeckDonnerRamamoorthi09], from its abstract: samples go to
// dyadic blocks whose scale coefficient varies much or whose wavelet coefficients stand out of the
// noise. For a block b of 2^k x 2^k pieces, with the orthonormal Haar transform of the piece means:
//
//   Var(s_b) = 4^-k sum of v over b
//   W_b = max(0, w_H^2 + w_V^2 + w_D^2 - 4 Var(s_b)) / 4^k, 0 for k = 0
//   P_b = (Var(s_b) + W_b) / (mean_b^2 + 0.01)
//
// Blocks lie on the dyadic grid only, which makes the density blocky: that is the method. The image
// is padded by half-sample symmetry to whole blocks of the largest level. An epoch takes the best
// blocks that do not overlap, then everything is computed again; so many epochs that each takes one
// block are the original loop. Results are indicative only.
// Slow twin: tests/reference/adaptive_wavelet_reference.h.
#pragma once

#include <optional>

#include "lib/sampling/sampler.h"

namespace spool {

enum class WaveletPriority { kRelative, kAbsolute };  // absolute: without the denominator

struct AdaptiveWaveletOptions {
  std::optional<int> init_spp;
  int levels = 4;
  WaveletPriority priority = WaveletPriority::kRelative;
  int epochs = 256;
};

const OptionTable<AdaptiveWaveletOptions>& adaptive_wavelet_option_table();

Result<SamplingResult> sample_adaptive_wavelet(const SamplePool& pool, long long budget,
                                               const AdaptiveWaveletOptions& options,
                                               const SamplingContext& context);

Sampler adaptive_wavelet_sampler();

}  // namespace spool
