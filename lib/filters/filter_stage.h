// What may stand before and behind any filter, those outside this program too:
//
//   clamp = on      the filter gets clamped samples (lib/kernels/sample_clamp.h)
//   residual = halves  what two halves of the samples agree that the filter took away comes back
//                   (lib/kernels/returned_residual.h)
//   energy = box    its image gets the energy of the mean of the samples taken, not clamped
//                   (lib/kernels/energy_step.h)
//   energy = first  the same of the first samples of each piece alone, as many as every piece has
//
// Both are off by default and cost nothing then. The energy of the box mean is that of the samples:
// what a sampler lost it does not bring back; that of the first samples, on which no decision
// rests, does. Where all pieces have as many samples the two energies are one. With halves of a
// selection each half is treated apart, so the energy of a sampler whose halves are unbiased stays
// unbiased. The variance that a filter reports is that of its image before the energy step.
#pragma once

#include "lib/filters/filter.h"

namespace spool {

enum class OwnOptions {
  kDescribed,      // all; an unknown name is refused here, where the nearest one is known
  kKnownWhenMade,  // of a filter from elsewhere: it refuses by itself
};

std::vector<OptionDescription> stage_options();

// `filter` with those of the options above that it describes none of the same name for.
Filter with_stage_options(Filter filter, OwnOptions own = OwnOptions::kDescribed);

}  // namespace spool
