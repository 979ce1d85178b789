// `spool replay`: a sampler spends a budget on a recording; the counts are written as an EXR.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "lib/core/view.h"
#include "lib/pool/load_recording.h"
#include "lib/pool/sample_pool.h"
#include "lib/sampling/sampler.h"
#include "tools/methods/method_settings.h"
#include "tools/terminal/console.h"
#include "tools/verbs/option_bounds.h"

namespace spool::tools {

struct ReplayOptions {
  std::filesystem::path dump;
  std::string sampler;
  std::string filter;  // in the loop of a sampler that requires one; empty: none
  double spp = 0.0;    // samples per pixel on average
  MethodOptions method;
  PoolOptions pool;
  bool decision_split = false;  // decision_split.h
  std::string views;            // "f,P.2": intermediate images
  std::filesystem::path output;
  std::filesystem::path pictures;  // folder; empty: none
};

Result<void> validate(const ReplayOptions& options);

Result<void> run_replay(const ReplayOptions& options, const CommonOptions& common);

// How a command gets its recording: what its methods need of it is known by then. The pass, which
// may be null, gets the samples if they are read now.
using LoadRecording = std::function<Result<std::shared_ptr<const RecordedSamples>>(
    const SanitiseRules&, const WorkingMemory&, SampleFilm, FirstPass*)>;

struct Replayed {
  SamplePool pool;
  SamplingResult sampled;
  Views views;  // those asked for, of the sampler and of its selection
  GuardCounts guards;
  double seconds = 0.0;
};

// The replay itself; nothing is read but through `load`, and nothing written.
Result<Replayed> replay(const ReplayOptions& options, const LoadRecording& load,
                        const std::function<void(double)>& progress);

// kData when the pool cannot pay for `spp` samples per pixel.
Result<long long> checked_budget(const SamplePool& pool, double spp);

}  // namespace spool::tools
