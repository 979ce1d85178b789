// Contrast-driven sampling after Mitchell 1987 [Mitchell87], from descriptions: the primary text
// was not available. A pixel is flagged when the contrast of its 3 x 3 neighbourhood exceeds a
// threshold in some channel:
//
//   C_c = (max_c - min_c) / (|max_c| + |min_c| + 1e-4),  ratio = max_c C_c / tau_c > 1
//
// Contrast is not a variance: a flagged pixel stays flagged, so rounds go to the least-sampled
// first, 4 samples each. Slow twin: tests/reference/mitchell_reference.h.
#pragma once

#include <array>
#include <optional>

#include "lib/sampling/sampler.h"

namespace spool {

struct MitchellOptions {
  std::optional<int> init_spp;  // per piece; empty: default_initial_samples()
  int rounds = 8;               // equal shares of the rest
};

// Samples of a piece in its turn.
inline constexpr int kMitchellTurn = 4;
// Contrast that flags a piece: red, green, blue; and where the first samples are grey everywhere.
inline constexpr std::array<double, 3> kMitchellThresholds = {0.4, 0.3, 0.6};
inline constexpr std::array<double, 3> kMitchellGreyThresholds = {0.4, 0.4, 0.4};

const OptionTable<MitchellOptions>& mitchell_option_table();

Result<SamplingResult> sample_mitchell(const SamplePool& pool, long long budget,
                                       const MitchellOptions& options,
                                       const SamplingContext& context);

Sampler mitchell_sampler();

}  // namespace spool
