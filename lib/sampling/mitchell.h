// Contrast-driven sampling after Mitchell 1987 [Mitchell87], from descriptions: the primary text
// was not available. A pixel is flagged when the contrast of its 3 x 3 neighbourhood exceeds a
// threshold in some channel:
//
//   C_c = (max_c - min_c) / (|max_c| + |min_c| + 1e-4),  ratio = max_c C_c / tau_c > 1
//
// Contrast is not a variance: a flagged pixel stays flagged, so rounds go to the least-sampled
// first. Slow twin: tests/reference/mitchell_reference.h.
#pragma once

#include <optional>

#include "lib/sampling/sampler.h"

namespace spool {

enum class MitchellMode {
  kMultiRound,      // equal shares; in each the flagged, least-sampled pixels get `per` samples
  kTwoLevelBudget,  // the largest ratios get n_high in all, as many as the budget pays
  kTwoLevel,        // every flagged pixel gets n_high in all: may leave budget unspent
};

struct MitchellOptions {
  MitchellMode mode = MitchellMode::kMultiRound;
  std::optional<int> init_spp;  // multi_round; the two-level modes start with n_base
  int n_base = 1, n_high = 9;
  int rounds = 8;
  int per = 4;
  int window = 3;  // 3 or 1 pieces
  double tau_red = 0.4, tau_green = 0.3, tau_blue = 0.6;
  double tau_grey = 0.4;  // where the initial samples are grey everywhere
  double key = 1.0;
};

const OptionTable<MitchellOptions>& mitchell_option_table();

Result<SamplingResult> sample_mitchell(const SamplePool& pool, long long budget,
                                       const MitchellOptions& options,
                                       const SamplingContext& context);

Sampler mitchell_sampler();

}  // namespace spool
