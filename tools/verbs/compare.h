// `spool compare A B`: what became better or worse from one folder of results to another, beyond
// the noise.
//
// Results are matched by scene, sampler, filter, budget and threads; samplers and filters by label,
// or by name and preset, which compares a change of options. Where both
// folders drew the same samples (same recordings by dumps.json, seed and order), differences are
// paired; otherwise the two are taken as independent. p-values are adjusted by Holm's rule over
// everything compared, so that of all comparisons together 5 % claim a difference where there is
// none.
#pragma once

#include <filesystem>
#include <string>

#include "tools/terminal/console.h"

namespace spool::tools {

struct CompareOptions {
  std::filesystem::path before, after;  // folders of spool evaluate
  std::string metrics = "relmse";       // of compared_metrics(), and cpu
  double significance = 0.05;
  double tolerance = 0.0;   // relative changes up to this are let pass
  bool all = false;         // also list what did not change
  bool match_name = false;  // methods by name and preset, whatever their options
};

Result<void> validate(const CompareOptions& options);
// kData when something became worse, failed, is incomplete or missing in `after`, or was judged
// differently.
Result<void> run_compare(const CompareOptions& options, const CommonOptions& common);

}  // namespace spool::tools
