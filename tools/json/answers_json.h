// What verbs that answer with a few numbers print with --json.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "lib/core/guards.h"
#include "lib/metrics/error_metrics.h"
#include "tools/batch/unused_layers.h"

namespace spool {
struct SamplingLog;
namespace format {
struct CheckReport;
struct PackReport;
struct RecoveryReport;
}  // namespace format
namespace interchange {
struct ExportReport;
struct ImportReport;
}  // namespace interchange
}  // namespace spool

namespace spool::tools {

std::string check_text(const std::string& file, const format::CheckReport& report);
std::string recovery_text(const std::filesystem::path& input, const std::filesystem::path& output,
                          const format::RecoveryReport& report);
std::string import_text(const std::filesystem::path& output,
                        const interchange::ImportReport& report);
std::string export_text(const std::filesystem::path& output, const std::string& format,
                        const interchange::ExportReport& report);
std::string pack_text(const std::filesystem::path& output, const format::PackReport& report);

// What `spool evaluate --dry-run` found.
struct DryRun {
  std::size_t cells = 0, done = 0, left = 0;
  double seconds = 0;            // for what is left, as far as its time is known
  std::size_t unknown_time = 0;  // of what is left
  std::vector<UnusedLayers> unused;
};
std::string dry_run_text(const DryRun& run);

// What a replay or a filter did, beside its images.
struct RunFacts {
  std::string method;
  std::filesystem::path output;
  GuardCounts guards;
  double seconds = 0;
};
std::string replay_text(const RunFacts& facts, const SamplingLog& log);
std::string reconstruction_text(const RunFacts& facts, int width, int height,
                                const std::vector<std::string>& notes);

// `values`: by the metric's name. Of numbers that are none: null, "inf", "-inf".
std::string metrics_text(const std::filesystem::path& image, const std::filesystem::path& reference,
                         const std::vector<std::pair<std::string, MetricValue>>& values,
                         const MetricTable& table);

struct Comparisons;
std::string comparisons_text(const Comparisons& comparisons);

}  // namespace spool::tools
