// The one interface of all samplers.
//
// A sampler spends a budget of samples on a pool: it may know only the samples it has taken. Any
// sampler works with any filter (lib/filters/filter.h); neither knows the other.
// The samplers of the library: lib/sampling/samplers.h.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/guards.h"
#include "lib/core/view.h"
#include "lib/methods/method.h"
#include "lib/pool/sample_pool.h"
#include "lib/statistics/selection.h"

namespace spool {

struct SamplingLog {
  long long budget = 0;   // samples asked for
  long long initial = 0;  // taken everywhere before the first decision
  long long spent = 0;  // taken in all; less than budget where the pool ran out or the method stops
  long long uniform_remainder = 0;  // spent uniformly because nothing had a priority
  long long saturated_pieces = 0;   // pieces that ran out of samples
  // Adaptive samples by queue level 0 .. K, if it has levels; 0: single pieces, or uniform.
  std::vector<long long> samples_of_level;
  double exchange_seconds = 0;  // of its time: starting a command and handing files over
  GuardCounts guards;
};

struct SamplingResult {
  Selection selection;
  SamplingLog log;
};

// The image that a selection gives: the filter beside a sampler, to one with a filter in its loop.
using LoopFilter = std::function<Result<RgbImage>(const Selection&, const SamplePool&)>;

struct SamplingContext {
  std::uint64_t seed = 0;                // of whatever is random in the method itself
  Views* views = nullptr;                // intermediate images wanted, may be null
  std::function<void(double)> progress;  // share of the work done, may be empty
  const std::function<bool()>* cancelled = nullptr;
  LoopFilter filter;  // for samplers with a filter in their loop, which refuse to work without
};

using SamplerFunction = std::function<Result<SamplingResult>(const SamplePool&, long long budget,
                                                             const SamplingContext&)>;
using Sampler = Method<SamplerFunction>;
using ReadySampler = Ready<SamplerFunction>;

}  // namespace spool
