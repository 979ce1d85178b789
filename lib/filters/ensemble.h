// A filter that is the mean of other filters. Errors of different filters are alike by 0.7 to 0.9
// only, so their mean has less error than each where they are about as good.
//
//   weights = mean     the same for all
//   weights = halves   per pixel, from the filters' images of the even and of the odd samples: each
//                      image of one half is judged by the mean of the other half, which shares no
//                      noise with it, so that better parts weigh more
//
// Halves cost three runs of each part. They need four samples in every piece; with fewer, weights
// are equal, which the result's notes say.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lib/filters/filter.h"

namespace spool {

inline constexpr std::size_t kMostEnsembleParts = 4;  // all subsets of the parts are tried

enum class EnsembleWeights { kMean, kHalves };

struct EnsembleOptions {
  EnsembleWeights weights = EnsembleWeights::kMean;
};

OptionTable<EnsembleOptions> ensemble_option_table();

// Of 2 to kMostEnsembleParts parts.
ReadyFilter ensemble(std::vector<ReadyFilter> parts, const EnsembleOptions& options);

// Images of the even and of the odd samples by one part, radiance units.
using HalfImages = std::array<RgbImage, 2>;

// [part][y][x], >= 0, sum 1: the convex weights with the least squared error, estimated over a
// Gaussian of 16 pixels. `means`: of the same samples, unfiltered and not clamped. `luminance`: of
// the scene, > 0.
std::vector<Plane> cross_fitted_weights(std::span<const HalfImages> parts, const HalfImages& means,
                                        double luminance);

}  // namespace spool
