#include "tools/evaluate.h"

#include <chrono>
#include <cstdio>
#include <memory>
#include <utility>

#include "formats/spool_reader.h"
#include "lib/evaluation/experiment.h"
#include "lib/evaluation/result_table.h"
#include "lib/pool/load_recording.h"
#include "tools/evaluation_pictures.h"
#include "tools/evaluation_summary.h"
#include "tools/progress.h"
#include "tools/run_manifest.h"

namespace spool::tools {
namespace {

// results.csv grows row by row under a temporary name, so that an interrupted run keeps what it
// has.
class ResultsFile {
 public:
  static Result<ResultsFile> create(const std::filesystem::path& target) {
    ResultsFile file(target);
    if (!file.stream_) {
      return fail(ErrorCode::kIo, "{}: cannot be written", file.partial_.string());
    }
    SPOOL_TRY(file.add(csv_header()));
    return file;
  }

  Result<void> add(const std::string& row) {
    const std::string line = row.ends_with('\n') ? row : row + "\n";
    if (std::fwrite(line.data(), 1, line.size(), stream_.get()) != line.size() ||
        std::fflush(stream_.get()) != 0) {
      return fail(ErrorCode::kIo, "{}: cannot be written: check the disk", partial_.string());
    }
    return {};
  }

  Result<void> finish() {
    stream_.reset();
    std::error_code status;
    std::filesystem::rename(partial_, target_, status);
    if (status) return fail(ErrorCode::kIo, "{}: {}", target_.string(), status.message());
    return {};
  }

 private:
  explicit ResultsFile(const std::filesystem::path& target)
      : target_(target),
        partial_(target.string() + ".partial"),
        stream_(std::fopen(partial_.c_str(), "w"), std::fclose) {}

  std::filesystem::path target_, partial_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream_;
};

Result<void> prepare_folder(const std::filesystem::path& folder, bool force) {
  std::error_code status;
  if (!force && std::filesystem::exists(folder, status) &&
      !std::filesystem::is_empty(folder, status)) {
    return fail(ErrorCode::kUsage,
                "{}: exists and is not empty: choose another name or give --force",
                folder.string());
  }
  std::filesystem::create_directories(folder, status);
  if (status) return fail(ErrorCode::kIo, "{}: {}", folder.string(), status.message());
  return {};
}

Result<std::vector<double>> parse_budgets(const std::string& text) {
  std::vector<double> budgets;
  for (const std::string& part : split_list(text)) {
    SPOOL_ASSIGN(const double spp, parse_number("--spp", part, 1e-3, 65536.0));
    budgets.push_back(spp);
  }
  if (budgets.empty()) return fail(ErrorCode::kUsage, "--spp: give budgets, for example 4,8,16");
  return budgets;
}

// What can be known to be wrong before hours of work.
Result<void> check_dumps(const EvaluateOptions& options, const std::vector<double>& budgets) {
  for (const std::filesystem::path& dump : options.dumps) {
    SPOOL_ASSIGN(const format::SpoolReader reader, format::SpoolReader::open(dump));
    for (const double spp : budgets) {
      if (spp > reader.header().spp) {
        return fail(ErrorCode::kData,
                    "{}: {} samples per pixel asked for, the pool has {}: use a smaller --spp or "
                    "record more",
                    dump.string(), spp, reader.header().spp);
      }
    }
  }
  return {};
}

Result<ExperimentOptions> experiment_options(const EvaluateOptions& options) {
  ExperimentOptions experiment;
  experiment.seed = options.seed;
  experiment.order = options.recorded_order ? PoolOrder::kRecorded : PoolOrder::kShuffled;
  experiment.holdout = options.holdout;
  if (!options.reference.empty()) {
    SPOOL_ASSIGN(experiment.reference, parse_reference_kind(options.reference));
  }
  return experiment;
}

// kData when cells failed or gave pixels that are no numbers; warnings for pools that ran out.
Result<void> verdict(const std::vector<CellResult>& results) {
  std::size_t failed = 0;
  std::size_t short_of_samples = 0;
  const CellResult* first = nullptr;
  std::string reason;
  for (const CellResult& result : results) {
    const bool bad = result.error || result.metrics.failed;
    failed += bad ? 1 : 0;
    short_of_samples += !bad && result.log.spent < result.log.budget ? 1 : 0;
    if (!bad || first) continue;
    first = &result;
    reason = result.error ? result.error->message : "the image holds pixels that are not finite";
  }
  if (short_of_samples > 0) {
    print_warning(
        fmt::format("{} of {} results spent less than their budget because the pool ran "
                    "out: column samples_spent",
                    short_of_samples, results.size()));
  }
  if (!first) return {};
  return fail(first->error ? first->error->code : ErrorCode::kData,
              "{} of {} results failed; the first, {} with {} at {} spp: {}", failed,
              results.size(), first->cell.sampler.label(), first->cell.filter.label(),
              first->cell.spp, reason);
}

}  // namespace

Result<void> run_evaluate(const EvaluateOptions& options, const CommonOptions& common) {
  const auto started = std::chrono::system_clock::now();
  SPOOL_ASSIGN(const Methods methods, choose_methods(split_list(options.samplers),
                                                     split_list(options.filters), options.methods));
  SPOOL_ASSIGN(const std::vector<double> budgets, parse_budgets(options.spp));
  SPOOL_ASSIGN(ExperimentOptions experiment, experiment_options(options));
  experiment.metrics = methods.metrics;
  SPOOL_TRY(check_dumps(options, budgets));
  SPOOL_TRY(prepare_folder(options.output, common.force));
  SPOOL_ASSIGN(ResultsFile file, ResultsFile::create(options.output / "results.csv"));

  std::vector<std::string> dumps;
  dumps.reserve(options.dumps.size());
  for (const auto& dump : options.dumps)
    dumps.push_back(dump.string());
  const std::vector<Cell> cells =
      all_cells(dumps, methods.samplers, methods.filters, budgets, options.replicates);
  const ExperimentSources sources{
      [&](const std::string& dump) { return load_recording(dump, methods.rules); },
      [](const MethodChoice& choice) { return make_sampler(choice); },
      [](const MethodChoice& choice) { return make_filter(choice); }};

  Progress progress("evaluate", common.quiet);
  EvaluationPictures pictures(options.output);
  Result<void> written;  // the first failure to write; the experiment itself goes on
  std::size_t done = 0;
  const ExperimentCallbacks callbacks{
      .finished =
          [&](const CellResult& result, const CellImages* images) {
            ++done;
            if (written) written = file.add(to_csv_row(result));
            if (written && images && !options.no_pictures) written = pictures.add(result, *images);
          },
      .progress =
          [&](double share) {
            progress.update(share, fmt::format("{} of {} results", done, cells.size()));
          },
      .cancelled = [&] { return !written.has_value(); }};
  const std::vector<CellResult> results = run_experiment(cells, experiment, sources, callbacks);
  SPOOL_TRY(written);
  if (!options.no_pictures) SPOOL_TRY(pictures.finish());
  SPOOL_TRY(file.finish());
  SPOOL_TRY(write_manifest(options.output, {options.dumps, started}));
  print(common.json ? summary_json(results) : summary_text(results));
  if (!common.json && !common.quiet) {
    print(fmt::format("\nnumbers: {}\n", (options.output / "results.csv").string()));
    if (!options.no_pictures) print(fmt::format("pictures: {}\n", pictures.describe()));
  }
  return verdict(results);
}

}  // namespace spool::tools
