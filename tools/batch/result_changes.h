// What changed between two folders of results, and whether it is more than the noise.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/experiment/plan.h"
#include "lib/experiment/result_record.h"
#include "lib/inference/comparison.h"

namespace spool::tools {

// Beside the metrics: processor seconds of sampling and filtering.
inline constexpr const char* kCpuTime = "cpu";

// One combination of recording, budget, threads, sampler and filter in one folder.
struct Combination {
  Cell cell;  // of replicate 0
  std::vector<ResultRecord> replicates;
};

struct ResultFolder {
  std::filesystem::path path;
  Plan plan;
  std::map<std::string, std::string> sha256;        // by file name of the recording
  std::map<std::string, Combination> combinations;  // by key
};

// kIo when `path` is not what spool evaluate wrote, kData when nothing in it is finished.
Result<ResultFolder> read_result_folder(const std::filesystem::path& path);

struct Change {
  std::string key, metric;
  double before = 0, after = 0;
  PairedComparison difference;  // after less before
  double p = 1;                 // adjusted
  bool paired = false, biased = false;
  std::string verdict;  // identical, same, better, worse
};

// One metric of one combination; `verdict` and `p` are those of this comparison alone until
// judge().
Change compare_one(const ResultFolder& a, const ResultFolder& b, const Combination& before,
                   const Combination& after, const std::string& metric);

// Verdicts at `significance` for all changes together (Holm's rule); relative changes up to
// `tolerance` are let pass.
void judge(std::vector<Change>& changes, double significance, double tolerance);

}  // namespace spool::tools
