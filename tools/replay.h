// `spool replay`: a sampler spends a budget on a recording; the counts are written as an EXR.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "lib/pool/sample_pool.h"
#include "tools/console.h"
#include "tools/methods/method_settings.h"

namespace spool::tools {

struct ReplayOptions {
  std::filesystem::path dump;
  std::string sampler;
  std::string filter;  // in the loop of a sampler that wants one; empty: none
  double spp = 0.0;    // samples per pixel on average
  MethodOptions method;
  PoolOptions pool;
  bool decision_split = false;  // decision_split.h
  std::string views;            // "f,P.2": intermediate images
  std::filesystem::path output;
  std::filesystem::path pictures;  // folder; empty: none
};

Result<void> run_replay(const ReplayOptions& options, const CommonOptions& common);

// kData when the pool cannot pay for `spp` samples per pixel.
Result<long long> checked_budget(const SamplePool& pool, double spp);

}  // namespace spool::tools
