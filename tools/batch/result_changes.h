// What changed between two folders of results, and whether it is more than the noise.
#pragma once

#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/experiment/plan.h"
#include "lib/inference/comparison.h"
#include "lib/study/method_results.h"
#include "tools/batch/dump_identity.h"

namespace spool::tools {

// Beside the metrics: processor seconds of sampling and filtering.
inline constexpr const char* kCpuTime = "cpu";

// What makes two results of two folders the same: the methods' labels, their names with presets, or
// their names alone; options count in labels only.
enum class MatchBy { kLabel, kPreset, kName };

// What a recording is of, as far as it and its results say it: another seed leaves this as it is.
struct Picture {
  std::string scene;   // scene_name()
  std::string size;    // empty: not known, of an older program
  double light = NAN;  // mean luminance of a recorded reference
};

// One scene, budget, number of threads, sampler and filter in one folder.
struct Combination {
  std::string key;  // as it is printed
  MethodResults results;
  std::vector<std::string> files;  // names of the scene's recordings
  std::string judged;              // by what: reference, samples held out, options
  Picture picture;
  int wanted = 0;  // replicates

  int missing() const { return wanted - results.done - results.failed; }
};

struct ResultFolder {
  std::filesystem::path path;
  Plan plan;
  std::map<std::string, DumpIdentity> dumps;        // by file name of the recording
  std::map<std::string, Combination> combinations;  // by what they are matched by
  std::string damage;                               // of its cells; empty: none
};

// kIo when `path` is not what spool evaluate wrote, kData when nothing in it is finished, kUsage
// when two of its results would be matched by the same name.
Result<ResultFolder> read_result_folder(const std::filesystem::path& path, MatchBy match);

struct Change {
  std::string key, metric;
  double before = 0, after = 0;  // means
  Comparison difference;         // after against before
  double p = 1;                  // adjusted
  bool paired = false, biased = false;
  std::string judged_differently;  // by what before and after; empty: alike
  Verdict verdict = Verdict::kUndecided;
};

// One metric of one combination; `verdict` and `p` hold after judge().
Change compare_one(const ResultFolder& a, const ResultFolder& b, const Combination& before,
                   const Combination& after, const std::string& metric);

// Verdicts at `significance` for all changes together (Holm's rule); relative changes up to
// `tolerance` are let pass.
void judge(std::vector<Change>& changes, double significance, double tolerance);

// A claim of the plans: "not asked" where a folder has it not.
struct ClaimChange {
  std::string text, before, after;
};

// Everything that two folders say of each other.
struct Comparisons {
  std::vector<ClaimChange> claims;
  std::vector<Change> changes;
  std::vector<std::string> newly_failed, only_before, only_after;  // combinations
  std::vector<std::string> incomplete;                             // and how many replicates
};

}  // namespace spool::tools
