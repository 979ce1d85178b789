// `spool evaluate`: every sampler with every filter at every budget, measured over replicates.
//
// The folder DIR gets results.csv (one row per cell and replicate; `spool list columns`), pictures
// of replicate 0 of every cell, and a sheet of all results per recording and budget.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/console.h"
#include "tools/method_settings.h"

namespace spool::tools {

struct EvaluateOptions {
  std::vector<std::filesystem::path> dumps;
  std::string samplers = "uniform";  // "a,b"
  std::string filters = "box";
  std::string spp;  // "4,8,16"
  int replicates = 5;
  MethodOptions methods;
  std::string reference;  // empty: the best there is
  std::optional<int> holdout;
  std::uint64_t seed = 1;
  bool recorded_order = false;
  bool no_pictures = false;
  std::filesystem::path output;  // DIR
};

Result<void> run_evaluate(const EvaluateOptions& options, const CommonOptions& common);

}  // namespace spool::tools
