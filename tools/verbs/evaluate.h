// `spool evaluate`: every sampler with every filter at every budget, measured over replicates.
//
// What to do is a plan file or options; the folder DIR gets results.csv and results.jsonl (one row
// per cell; `spool list columns`), pictures of replicate 0 of every cell, a sheet of all results
// per recording and budget, statistics.json, manifest.json, plan.toml, and the finished cells from
// which a run that was interrupted goes on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/methods/method_settings.h"
#include "tools/terminal/console.h"

namespace spool::tools {

struct EvaluateOptions {
  std::vector<std::filesystem::path> files;  // recordings, or one PLAN.toml
  std::string samplers;                      // "a,b"; empty: uniform
  std::string filters;                       // empty: box
  std::string spp;                           // "4,8,16"
  std::string cell_threads;                  // "1,2": a sweep; empty: --threads
  std::optional<int> replicates;             // 8
  std::optional<int> repeats;                // 1
  MethodOptions methods;
  std::string reference;  // empty: the best there is
  std::optional<int> holdout;
  std::optional<std::uint64_t> seed;  // 1
  bool recorded_order = false;
  std::optional<int> pieces_per_side;  // 1
  bool decision_split = false;
  bool fresh = false;
  std::string baseline;  // "SAMPLER + FILTER"; empty: uniform + box
  bool wide = false;
  bool no_pictures = false;
  bool dry_run = false;
  std::string timing;    // "shared" or "exact"; empty: shared
  std::string shard;     // "i/N"
  std::string executor;  // "dask:ADDRESS", "processes:N", "mpi": sampling runs are made there
  bool merge = false;
  bool statistics_only = false;  // files: folders of results
  std::vector<std::filesystem::path> merge_from;
  std::filesystem::path output;  // DIR
  std::filesystem::path inputs;  // instead of it: a folder for what a denoiser elsewhere needs
};

// What a plan says is looked at where it is read (lib/experiment/plan.h).
Result<void> validate(const EvaluateOptions& options);

Result<void> run_evaluate(const EvaluateOptions& options, const CommonOptions& common);

}  // namespace spool::tools
