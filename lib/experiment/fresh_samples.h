// Where a gain comes from: the counts that a method decides on applied to samples that had no part
// in them, and its error in two parts, bias and variance.
//
// The even and the odd samples of every piece are two pools (SamplePool::half). A sampler runs on
// each with the whole budget. Its own image of a half is made of the samples that decided, as the
// method always works; the fresh image of the other half is made of as many samples there, of which
// none decided about its own count. An adaptive mean of own samples loses energy where a pixel
// looked quiet by chance (docs/method.md), and errors count the loss of a rare bright sample as a
// gain; the fresh image keeps the distribution of the samples and loses that. The two own images
// share no sample, so they say what of the error is variance and what is bias
// (lib/metrics/error_parts.h), without an assumption about replicates that share a pool.
//
// Both halves hold half of the pool's samples, so pieces run out earlier than in the image that the
// cell itself is judged by: `saturated_share` says how many. Costs two more runs of the sampler and
// four of the filter.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/inference/half_spread.h"
#include "lib/metrics/error_parts.h"
#include "lib/pool/sample_pool.h"
#include "lib/statistics/selection.h"

namespace spool {

struct HalfSelections {
  std::array<Selection, 2> own;  // [half] what a sampler took there
  // [half] the counts that it decided on with the other half; absent: not asked for.
  std::optional<std::array<Selection, 2>> fresh;
  double saturated_share = 0.0;  // pieces of which it took everything, mean of both halves
};

struct FreshErrors {
  double mse = 0.0, relmse = 0.0;  // means over the two fresh images
  double energy_ratio = 0.0;
  ErrorParts parts;  // of the two own images
  double saturated_share = 0.0;
};

// A metric of the images of the two halves (lib/inference/half_spread.h): of the own images by its
// name, of the fresh ones as NAME_fresh.
struct MetricHalves {
  std::string metric;
  HalfDifference difference;
};

struct HalfErrors {
  std::optional<FreshErrors> fresh;  // where the selections have fresh samples
  std::vector<MetricHalves> differences;
};

// The sampler and the filter of a cell: `half` is 0 or 1.
using SelectHalf = std::function<Result<Selection>(const SamplePool&, std::size_t half)>;
using FilterHalf = std::function<Result<RgbImage>(const Selection&, const SamplePool&)>;

// The counts of `decided`, those of its halves too, applied to `pool`, as far as it goes.
Selection with_samples_of(const SamplePool& pool, const Selection& decided);

// Nothing when a half holds fewer than `budget` samples. Errors: those of the sampler.
Result<std::optional<HalfSelections>> select_halves(const SamplePool& pool, long long budget,
                                                    bool fresh, const SelectHalf& sample);

// Shortest prefixes of the whole pool that hold all that was looked at: no reference may be made of
// these samples.
CountImage looked_at(const SamplePool& pool, const HalfSelections& halves);

// Errors: those of the filter. `reference` is made of none of the samples in `halves`. `taken`: of
// a replicate that has the whole pool, the samples of every piece.
Result<HalfErrors> judge_halves(const SamplePool& pool, const HalfSelections& halves,
                                const CountImage& taken, const JudgingReference& reference,
                                const MetricOptions& options, const FilterHalf& filter);

// Of the two halves of crossfit.
FreshErrors mean_of(const std::vector<FreshErrors>& errors);

}  // namespace spool
