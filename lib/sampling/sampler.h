// The one interface of all samplers, and their list.
//
// A sampler spends a budget of samples on a pool: it may know only the samples it has taken. Any
// sampler works with any reconstructor (lib/filters/reconstructor.h); neither knows the
// other.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/guards.h"
#include "lib/core/option_table.h"
#include "lib/core/view.h"
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
  GuardCounts guards;
};

struct SamplingResult {
  Selection selection;
  SamplingLog log;
};

// The image that a selection gives; what a reconstructor is to a sampler that filters in its loop.
using FilterFunction = std::function<Result<RgbImage>(const Selection&, const SamplePool&)>;

struct SamplingContext {
  std::uint64_t seed = 0;                // of whatever is random in the method itself
  Views* views = nullptr;                // intermediate images wanted, may be null
  std::function<void(double)> progress;  // share of the work done, may be empty
  const std::function<bool()>* cancelled = nullptr;
  FilterFunction filter;  // for samplers with a filter in their loop, which refuse to work without
};

using SamplerFunction = std::function<Result<SamplingResult>(const SamplePool&, long long budget,
                                                             const SamplingContext&)>;

struct SamplerEntry {
  std::string name;
  std::string summary;
  bool by_description = false;       // re-implemented from descriptions, not from the primary text
  std::vector<std::string> presets;  // the first is the default; empty: no presets
  std::string argument;              // "FILE.exr": what NAME:... takes where others have a preset
  std::function<std::vector<OptionDescription>(std::string_view preset)> describe;
  std::function<Result<SamplerFunction>(std::string_view preset, const OptionValues& set)> make;
};

// All samplers by name, in the order in which people should read them.
const std::vector<SamplerEntry>& samplers();
// Error kUsage, with the nearest known name, when there is no such sampler, preset or option.
Result<SamplerFunction> make_sampler(std::string_view name, std::string_view preset,
                                     const OptionValues& set);

// The views that a sampler of the list can hand over; empty for unknown names.
std::vector<ViewDescription> sampler_views(std::string_view name);

// Budget in samples for a number of samples per pixel, which need not be whole.
long long sample_budget(double samples_per_pixel, const RecordedSamples& recording);

long long count_samples(const CountImage& n);
// Pieces of which every offered sample was taken.
long long count_saturated(const SamplePool& pool, const CountImage& n);

// What every sampler reports at its end: saturated pieces, and the guards that follow from the log.
void finish_log(SamplingLog& log, const SamplePool& pool, const CountImage& n);

}  // namespace spool
