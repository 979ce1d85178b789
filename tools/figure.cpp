#include "tools/figure.h"

#include <utility>

#include "tools/evaluate.h"
#include "tools/page_generator.h"

namespace spool::tools {

Result<void> run_figure(const FigureOptions& options, const CommonOptions& common) {
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
                                    fmt::format("--spp={}", options.spp)};
  for (const std::string& name : options.recordings)
    words.push_back("--recording=" + name);
  for (const std::string& name : options.methods)
    words.push_back("--method=" + name);
  if (common.force) words.emplace_back("--force");
  words.insert(words.end(), {"--", folder.string()});
  SPOOL_ASSIGN(const std::string said,
               run_generator("figure.py", std::move(words), "",
                             {"spool figure", "numpy and matplotlib", "python3-matplotlib"}));
  if (!common.quiet) print_line(said);
  return {};
}

}  // namespace spool::tools
