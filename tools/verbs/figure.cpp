#include "tools/verbs/figure.h"

#include <utility>

#include "lib/metrics/metric_options.h"
#include "tools/methods/external_methods.h"
#include "tools/verbs/evaluate.h"
#include "tools/verbs/option_bounds.h"
#include "tools/verbs/page_generator.h"

namespace spool::tools {
namespace {

// "uniform,multiscale,...": every other method is the user's own, and so are commands and images,
// which the script knows.
std::string built_in_names() {
  std::string names;
  for (const Sampler& sampler : known_samplers())
    names += sampler.name + ",";
  for (const Filter& filter : known_filters())
    names += filter.name + ",";
  return names;
}

}  // namespace

Result<void> validate(const FigureOptions& options) {
  if (!options.metric.empty()) SPOOL_TRY(metrics_named({options.metric}));
  SPOOL_TRY(check_bounds("spp", options.spp, kFigureSpp));
  return check_bounds("column", options.column, kColumns);
}

Result<void> run_figure(const FigureOptions& options, const CommonOptions& common) {
  SPOOL_TRY(validate(options));
  std::filesystem::path folder = options.source;
  if (options.source.extension() == ".toml") {
    folder = options.output / "results";
    EvaluateOptions evaluate;
    evaluate.files = {options.source};
    evaluate.output = folder;
    CommonOptions kept = common;
    kept.force = false;  // --force replaces figures, not results
    SPOOL_TRY(run_evaluate(evaluate, kept));
  }
  std::vector<std::string> words = {"--output=" + options.output.string(),
                                    "--metric=" + options.metric,
                                    fmt::format("--spp={}", options.spp),
                                    fmt::format("--column={}", options.column),
                                    "--font=" + options.font,
                                    "--built-in=" + built_in_names()};
  for (const std::string& name : options.recordings)
    words.push_back("--recording=" + name);
  for (const std::string& name : options.methods)
    words.push_back("--method=" + name);
  for (const std::string& crop : options.crops)
    words.push_back("--crops=" + crop);
  if (common.force) words.emplace_back("--force");
  words.insert(words.end(), {"--", folder.string()});
  SPOOL_ASSIGN(const std::string said,
               run_generator("figure", std::move(words), "",
                             {"spool figure", "numpy and matplotlib", "python3-matplotlib"}));
  if (!common.quiet) print_line(said);
  return {};
}

}  // namespace spool::tools
