#include "tools/report_verb.h"

#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "lib/core/guards.h"
#include "lib/experiment/result_table.h"
#include "tools/page_generator.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;

const char* name_of(Better better) {
  return better == Better::kLower ? "lower" : (better == Better::kHigher ? "higher" : "one");
}

// The meanings that tools/report/vocabulary.py reads.
std::string vocabulary_json() {
  nlohmann::ordered_json words = {{"version", SPOOL_VERSION}};
  for (const MetricDescription& metric : metrics()) {
    words["metrics"].push_back(
        {{"name", metric.name}, {"meaning", metric.meaning}, {"better", name_of(metric.better)}});
  }
  for (const ResultColumn& column : result_columns()) {
    words["columns"].push_back({{"name", column.name}, {"meaning", column.meaning}});
  }
  for (std::size_t g = 0; g < kGuardCount; ++g) {
    const auto guard = static_cast<Guard>(g);
    words["guards"].push_back({{"name", std::string(guard_name(guard))},
                               {"protects", std::string(guard_protects(guard))}});
  }
  return words.dump();
}

}  // namespace

Result<void> run_report(const ReportOptions& options, const CommonOptions& common) {
  std::vector<std::string> words = {"--output=" + options.output.string(),
                                    "--metric=" + options.metric, "--title=" + options.title,
                                    fmt::format("--max-image-mb={}", options.max_image_mb),
                                    "--vocabulary=/dev/stdin"};
  // For the samples of single pixels, which the program reads (`spool pixel`).
  std::error_code status;
  const fs::path self = fs::read_symlink("/proc/self/exe", status);
  if (!status) words.push_back("--program=" + self.string());
  if (common.force) words.emplace_back("--force");
  words.insert(words.end(), {"--", options.folder.string()});
  SPOOL_ASSIGN(const std::string said,
               run_generator("report.py", std::move(words), vocabulary_json(),
                             {"spool report", "numpy", "python3-numpy"}));
  if (!common.quiet) print_line(said);
  return {};
}

}  // namespace spool::tools
