// A filter that is the mean of other filters. Errors of different filters are alike by 0.7 to 0.9
// only, so their mean has less error than each where they are about as good.
//
//   weights = mean     the same for all
//   weights = halves   per pixel, by the error of each part on half of the samples
//                      (ensemble_weights.h), so that better parts weigh more
//
// Halves cost three runs of each part. They need three samples in every piece; with fewer, weights
// are equal, which the result's notes say.
#pragma once

#include <vector>

#include "lib/filters/ensemble_weights.h"
#include "lib/filters/filter.h"

namespace spool {

enum class EnsembleWeights { kMean, kHalves };

struct EnsembleOptions {
  EnsembleWeights weights = EnsembleWeights::kMean;
};

OptionTable<EnsembleOptions> ensemble_option_table();

// Of 2 to kMostEnsembleParts parts.
ReadyFilter ensemble(std::vector<ReadyFilter> parts, const EnsembleOptions& options);

}  // namespace spool
