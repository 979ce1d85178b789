#include "tools/verbs/report.h"

#include <system_error>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "formats/file_handle.h"
#include "formats/target_watch.h"
#include "lib/core/guards.h"
#include "lib/experiment/result_table.h"
#include "lib/filters/filters.h"
#include "lib/image_io/atomic_file.h"
#include "lib/metrics/metric_options.h"
#include "lib/sampling/samplers.h"
#include "tools/batch/cell_store.h"
#include "tools/verbs/option_bounds.h"
#include "tools/verbs/page_generator.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;

// The meanings that tools/report/vocabulary.py reads.
std::string vocabulary_json() {
  nlohmann::ordered_json words = {{"version", SPOOL_VERSION}};
  for (const MetricDescription& metric : metrics()) {
    words["metrics"].push_back({{"name", metric.name},
                                {"better", better_name(metric.better)},
                                {"meaning", metric.meaning}});
  }
  for (const ResultColumn& column : result_columns()) {
    words["columns"].push_back({{"name", column.name}, {"meaning", column.meaning}});
  }
  for (std::size_t g = 0; g < kGuardCount; ++g) {
    const auto guard = static_cast<Guard>(g);
    words["guards"].push_back({{"name", std::string(guard_name(guard))},
                               {"protects", std::string(guard_protects(guard))}});
  }
  // Methods of the program itself whose weights may be asked for: names in a folder of results may
  // be commands of other users.
  for (const Sampler& sampler : samplers()) {
    if (sampler.argument.empty()) words["samplers"].push_back(sampler.name);
  }
  for (const Filter& filter : filters()) {
    if (filter.footprints) words["footprints"].push_back(filter.name);
  }
  return words.dump();
}

// What the report script is asked, and its answer.
Result<std::string> make_report(const ReportOptions& options, std::vector<std::string> words) {
  words.insert(words.end(),
               {"--output=" + options.output.string(), "--metric=" + options.metric,
                "--title=" + options.title, fmt::format("--max-image-mb={}", options.max_image_mb),
                "--vocabulary=/dev/stdin"});
  // For samples of single pixels (`spool pixel`) and FLIP maps (`spool picture`).
  std::error_code status;
  const fs::path self = fs::read_symlink("/proc/self/exe", status);
  if (!status) words.push_back("--program=" + self.string());
  words.insert(words.end(), {"--", options.folder.string()});
  return run_generator("report", std::move(words), vocabulary_json(),
                       {"spool report", "numpy", "python3-numpy"});
}

}  // namespace

Result<void> validate(const ReportOptions& options) {
  if (!options.metric.empty()) SPOOL_TRY(metrics_named({options.metric}));
  return check_bounds("max-image-mb", options.max_image_mb, kImageMb);
}

Result<void> run_report(const ReportOptions& options, const CommonOptions& common) {
  SPOOL_TRY(validate(options));
  SPOOL_TRY(refuse_existing(options.output, common.force));
  SPOOL_TRY(format::refuse_special_file(options.output));
  std::error_code ignored;
  for (const auto& entry : fs::recursive_directory_iterator(options.folder, ignored))
    if (entry.path().extension() != ".html")
      SPOOL_TRY(format::refuse_own_input(options.output, entry));
  std::vector<std::string> words;
  // The report is of results.csv: cells that were damaged since are missing in the next.
  if (const auto store = CellStore::open(options.folder); store && store->damaged() > 0)
    print_warning(store->damage());
  if (common.force) words.emplace_back("--force");
  SPOOL_ASSIGN(const std::string said, make_report(options, std::move(words)));
  if (!common.quiet) print_line(said);
  return {};
}

Result<std::string> served_report(const std::filesystem::path& folder) {
  ReportOptions options;
  options.folder = folder;
  options.output = "-";
  return make_report(options, {"--served"});
}

}  // namespace spool::tools
