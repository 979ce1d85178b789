#include "tools/batch/evaluation_run.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <fstream>
#include <mutex>
#include <set>
#include <unordered_map>
#include <utility>

#include "formats/spool_reader.h"
#include "lib/experiment/plan_cells.h"
#include "lib/experiment/plan_text.h"
#include "lib/experiment/result_record.h"
#include "lib/experiment/result_table.h"
#include "lib/experiment/run_cells.h"
#include "lib/image_io/atomic_file.h"
#include "lib/metrics/error_metrics.h"
#include "lib/pool/load_recording.h"
#include "lib/study/ranked_results.h"
#include "tools/batch/best_so_far.h"
#include "tools/batch/cell_store.h"
#include "tools/batch/dump_identity.h"
#include "tools/batch/evaluation_pictures.h"
#include "tools/batch/evaluation_summary.h"
#include "tools/batch/given_images.h"
#include "tools/batch/input_files.h"
#include "tools/batch/merged_folders.h"
#include "tools/batch/results_writer.h"
#include "tools/batch/run_folder.h"
#include "tools/batch/run_manifest.h"
#include "tools/batch/run_tasks.h"
#include "tools/batch/time_estimate.h"
#include "tools/json/study_json.h"
#include "tools/methods/external_methods.h"
#include "tools/methods/method_memory.h"
#include "tools/methods/replicate_images.h"
#include "tools/terminal/interrupt.h"
#include "tools/terminal/progress.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;

Result<void> write_statistics_file(const fs::path& path, const Study& study) {
  SPOOL_ASSIGN(AtomicFile file, AtomicFile::create(path, true, true));
  std::ofstream out(file.temporary_path(), std::ios::binary);
  write_statistics(out, study);
  out.close();
  if (!out) {
    return fail(ErrorCode::kIo, "{}: cannot be written: check the disk",
                file.temporary_path().string());
  }
  return file.commit();
}

Result<void> write_study(const fs::path& folder, Study study, const CommonOptions& common,
                         bool wide, const CellStore& store) {
  if (study.results.empty()) return nothing_finished(folder, store);
  mark_late_claims(folder, study.claims);
  SPOOL_TRY(write_statistics_file(folder / "statistics.json", study));
  if (common.json) print(study_text(study));
  if (!common.json && !common.quiet) print(summary_text(study, wide));
  return {};
}

bool has_result(const ResultRecord& record) {
  return !record.text("reference").empty();
}

double pixels_of(const std::string& dump) {
  const auto reader = format::SpoolReader::open(dump);
  return reader ? static_cast<double>(reader->header().width) * reader->header().height : 0.0;
}

class PlanRun {
 public:
  PlanRun(const RunRequest& request, const CommonOptions& common, NamedCells named,
          std::vector<bool> chosen, CellStore store)
      : request_(request),
        common_(common),
        named_(std::move(named)),
        chosen_(std::move(chosen)),
        store_(std::move(store)),
        pictures_(request.folder, request.plan.recordings),
        estimate_(std::vector<Cell>(), pixels_of) {}

  // Runs what is missing.
  Result<void> run() {
    find_missing();
    if (missing_.empty()) return {};
    SPOOL_TRY(check_given_images(request_.plan, missing_));
    estimate_ = TimeEstimate(missing_, pixels_of);
    for (const auto& [cell, record] : learnt_)
      estimate_.learn(cell, record);
    learnt_.clear();
    Progress progress("evaluate", common_.quiet);
    const InterruptNote note([this] {
      // Until the process ends: no line follows the count. A disk that hangs does not hold it up.
      static_cast<void>(keeping_.try_lock_for(std::chrono::seconds(1)));
      return kept_text();
    });
    const int pieces = request_.plan.experiment.pieces_per_side;
    SPOOL_ASSIGN(const PlanDemands methods,
                 demands_of(request_.plan.samplers, request_.plan.filters));
    const WorkingMemory memory = evaluation_memory(methods.samplers, methods.filters, pieces,
                                                   request_.plan.experiment.halves > 0);
    const SampleFilm film = film_for(methods.samplers, methods.filters, pieces);
    std::shared_ptr<const RecordedSamples> recording;  // that of the cells at work
    const ExperimentSources sources{
        [&](const std::string& dump) {
          recording.reset();  // frees the last one before the next is read
          auto loaded = load_recording(dump, request_.plan.rules, memory, film);
          if (loaded) recording = *loaded;
          return loaded;
        },
        [](const MethodChoice& choice) { return make_method(known_samplers(), choice); },
        [](const MethodChoice& choice) { return make_method(known_filters(), choice); },
        [&](const RecordedSamples& samples) {
          at_once_ = request_.exact_timing ? 1 : runs_at_once(request_.plan, samples, memory);
          return at_once_.load();
        }};
    Result<void> written;  // the first failure to write ends the run
    const ExperimentCallbacks callbacks{
        .finished =
            [&](CellResult& result, const CellImages* images) {
              if (const auto intact = still_intact(recording); !intact) {
                result.error = intact.error();
                images = nullptr;
              }
              result.cell = cell_of_.at(key_of(result.cell));
              if (written) written = keep(result, images);
            },
        .progress =
            [&](double share) {
              progress.update(
                  estimate_.known() ? estimate_.share_done() : share,
                  fmt::format("{} of {} results{}", done_.load(), wanted_, best_.describe()),
                  estimate_.known() ? std::optional(estimate_.seconds_left() / at_once_)
                                    : std::nullopt);
              if (request_.progress) request_.progress(share, done_.load(), wanted_);
            },
        .cancelled = [&] { return !written.has_value() || stopped(); }};
    std::vector<Cell> filled;  // with the file names of their images
    for (const Cell& cell : missing_)
      cell_of_.emplace(key_of(filled.emplace_back(with_filled_names(cell))), cell);
    run_cells(filled, request_.plan.experiment, sources, callbacks);
    SPOOL_TRY(written);
    SPOOL_TRY(store_.sync());
    if (!stopped()) return {};
    return fail(ErrorCode::kData, "interrupted; {}", kept_text());
  }

  // What is there becomes results.csv, results.jsonl, statistics, sheets and the printed summary.
  Result<void> collect() {
    SPOOL_ASSIGN(store_, CellStore::open(request_.folder));
    if (!request_.merge && !common_.force && count_others(store_, named_) > 0) {
      return fail(ErrorCode::kUsage,
                  "{}: another plan was run in it meanwhile: evaluate each into a folder of its "
                  "own; what this one finished is in {}",
                  request_.folder.string(), (request_.folder / "cells").string());
    }
    SPOOL_ASSIGN(ResultsWriter writer, ResultsWriter::create(request_.folder));
    std::vector<PicturedResult> pictured;
    std::size_t missing = 0;
    StudySources sources = study_sources(store_, request_.plan);
    sources.read = [&, read = sources.read](const Cell& cell) {
      Result<ResultRecord> record = read(cell);
      if (!record) {
        ++missing;
        return record;
      }
      writer.add(record->fields);
      any_shared_ = any_shared_ || record->text("timing") == "shared";
      judge(cell, *record);
      if (is_pictured(cell)) pictured.push_back({cell, record->number("relmse")});
      return record;
    };
    Study study = study_of(request_.plan, sources);
    SPOOL_TRY(writer.finish());
    SPOOL_TRY(write_study(request_.folder, std::move(study), common_, request_.wide, store_));
    std::string sheets;
    if (request_.plan.pictures) {
      SPOOL_ASSIGN(sheets, pictures_.write_sheets(pictured));
    }
    if (!common_.json && !common_.quiet) {
      print("\n");
      if (any_shared_ && request_.wide) {
        print(wrapped("times: of a machine that other results shared (column timing); --timing "
                      "exact --force makes them anew, one after another",
                      line_width()) +
              "\n");
      }
      print_line(fmt::format("numbers: {}", (request_.folder / "results.csv").string()));
      if (!sheets.empty()) print_line(fmt::format("pictures: {}", sheets));
      if (!pictured.empty()) {
        print_line(fmt::format("of each result: spool picture {}", request_.folder.string()));
      }
    }
    return verdict(missing);
  }

  // The results of a shard are made later; its failures are printed now.
  Result<void> report_shard() {
    SPOOL_ASSIGN(store_, CellStore::open(request_.folder));
    for (std::size_t i = 0; i < named_.size(); ++i) {
      if (!chosen_[i]) continue;
      if (const auto record = store_.read(named_.id(i), named_.cell(i))) {
        judge(named_.cell(i), *record);
      }
    }
    if (!common_.quiet && request_.shard) {
      print_line(fmt::format("shard {}/{}: {} of {} results in {}", request_.shard->index,
                             request_.shard->count, done_.load(), wanted_,
                             request_.folder.string()));
    }
    return verdict(0);
  }

 private:
  bool stopped() const { return request_.cancelled && request_.cancelled(); }

  std::string kept_text() const {
    return fmt::format("{} of {} results are kept in {}: the same command goes on from there",
                       done_.load(), wanted_, request_.folder.string());
  }

  bool is_pictured(const Cell& cell) const {
    return request_.plan.pictures && cell.replicate == 0 &&
           cell.threads == request_.plan.threads.front();
  }

  void find_missing() {
    for (std::size_t i = 0; i < named_.size(); ++i) {
      const Cell cell = named_.cell(i);
      if (!chosen_[i]) continue;
      ++wanted_;
      Result<ResultRecord> record = store_.read(named_.id(i), cell);
      if (record && has_result(*record)) {
        ++done_;
        best_.add(cell, record->number("relmse"));
        if (learnt_.size() < kLearntFrom) learnt_.emplace_back(cell, std::move(*record));
        continue;
      }
      missing_.push_back(cell);
      id_of_.emplace(key_of(cell), named_.id(i));
    }
  }

  static std::string key_of(const Cell& cell) {
    return fmt::format("{}\n{}\n{}\n{}\n{}\n{}", cell.dump, cell.sampler.text(), cell.filter.text(),
                       cell.spp, cell.replicate, cell.threads);
  }

  Result<void> keep(CellResult& result, const CellImages* images) {
    const Cell& cell = result.cell;
    if (images && cell.filter.name == "image" &&
        is_the_reference(images->image, images->reference.mean))
      references_.insert(fmt::format("{} is the reference of {}", cell.filter.label(), cell.dump));
    if (images && is_pictured(cell)) {
      const StageClock clock(result.alone ? CpuOf::kProcess : CpuOf::kThread);
      const Result<void> drawn = pictures_.add(result, *images);
      if (!drawn && drawn.error().code != ErrorCode::kData) return drawn;
      if (!drawn && undrawn_++ == 0) first_undrawn_ = drawn.error().message;
      result.writing = clock.elapsed();
    }
    if (!images && is_pictured(cell)) pictures_.remove(cell);
    // Tasks of an executor may share their machine.
    if (request_.only && !request_.exact_timing) result.alone = false;
    const ResultRecord record = record_of(result);
    {
      const std::scoped_lock lock(keeping_);
      SPOOL_TRY(store_.write(id_of_.at(key_of(cell)), record));
      ++done_;
    }
    best_.add(cell, record.number("relmse"));
    estimate_.learn(cell, record);
    estimate_.finished(cell);
    return {};
  }

  void judge(const Cell& cell, const ResultRecord& record) {
    ++results_;
    if (record.failed()) {
      ++failed_;
      if (first_failure_.empty()) {
        first_failure_ = fmt::format("{} with {} at {} spp: {}", cell.sampler.label(),
                                     cell.filter.label(), cell.spp, record.text("error"));
      }
      return;
    }
    if (std::isinf(record.number("energy_ratio"))) black_references_.insert(cell.dump);
    const double budget = std::round(cell.spp * record.number("width") * record.number("height"));
    if (record.number("samples_spent") < budget)
      ++(cell.sampler.name == "counts" ? asked_for_fewer_ : short_of_samples_);
  }

  // kData when cells are missing, failed or gave pixels that are no numbers; a warning for pools
  // that ran out.
  Result<void> verdict(std::size_t missing) const {
    if (short_of_samples_ > 0) {
      print_warning(
          fmt::format("{} of {} results spent less than their budget because the recording ran "
                      "out: column samples_spent",
                      short_of_samples_, results_));
    }
    if (asked_for_fewer_ > 0) {
      print_warning(
          fmt::format("{} of {} results spent less than their budget because their file of counts "
                      "asks for fewer samples: column samples_spent",
                      asked_for_fewer_, results_));
    }
    if (undrawn_ > 0) {
      print_warning(fmt::format("{} of {} results lack an image; the first: {}", undrawn_, results_,
                                first_undrawn_));
    }
    for (const std::string& found : references_)
      print_warning(found + ": its error has no meaning");
    for (const std::string& recording : black_references_)
      print_warning(recording +
                    ": its reference is black and results are not: their errors are the light "
                    "itself: pack the recording with a reference of the same picture");
    if (missing > 0) {
      return fail(
          ErrorCode::kData,
          "{}: {} of {} results are missing: run the plan or its shards again, then --merge",
          request_.folder.string(), missing, named_.size());
    }
    if (failed_ == 0) return {};
    return fail(ErrorCode::kData, "{} of {} results failed; the first, {}", failed_, results_,
                first_failure_);
  }

  static constexpr std::size_t kLearntFrom = 200;  // finished cells whose times are looked at

  const RunRequest& request_;
  const CommonOptions& common_;
  NamedCells named_;
  std::vector<bool> chosen_;  // of these cells, those of this run
  CellStore store_;
  EvaluationPictures pictures_;
  TimeEstimate estimate_;
  BestSoFar best_;
  std::vector<Cell> missing_;
  std::unordered_map<std::string, std::string> id_of_;  // of what is missing
  std::unordered_map<std::string, Cell> cell_of_;       // by its key with file names filled in
  std::vector<std::pair<Cell, ResultRecord>> learnt_;
  std::atomic<std::size_t> done_ = 0;
  std::timed_mutex keeping_;      // a line on the disk, and its count
  std::atomic<int> at_once_ = 1;  // sampling runs beside each other
  std::size_t wanted_ = 0;
  std::size_t results_ = 0, failed_ = 0, short_of_samples_ = 0, asked_for_fewer_ = 0;
  std::size_t undrawn_ = 0;  // results with an image that cannot hold its numbers
  std::string first_failure_, first_undrawn_;
  std::set<std::string> references_;        // images that are no estimate
  std::set<std::string> black_references_;  // of recordings
  bool any_shared_ = false;                 // times are of a machine that other results shared
};

}  // namespace

Result<void> write_statistics(const fs::path& folder, const Plan& plan, const CommonOptions& common,
                              bool wide) {
  SPOOL_ASSIGN(const CellStore store, CellStore::open(folder));
  std::size_t missing = 0, all = 0;
  StudySources sources = study_sources(store, plan);
  sources.read = [&, read = std::move(sources.read)](const Cell& cell) {
    Result<ResultRecord> record = read(cell);
    missing += !record;
    ++all;
    return record;
  };
  Study study = study_of(plan, sources);
  if (store.damaged() > 0 && !study.results.empty()) print_warning(store.damage());
  if (missing > 0 && !study.results.empty()) {
    print_warning(fmt::format(
        "{}: {} of {} results are missing: spool evaluate {} -o {} makes them", folder.string(),
        missing, all, (folder / "plan.toml").string(), folder.string()));
  }
  return write_study(folder, std::move(study), common, wide, store);
}

Result<Shard> parse_shard(const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash != std::string::npos) {
    const auto count = parse_integer("--shard", text.substr(slash + 1), 1, 1 << 20);
    const auto index = parse_integer("--shard", text.substr(0, slash), 0, 1 << 20);
    if (count && index && *index < *count) return Shard{*index, *count};
  }
  return fail(ErrorCode::kUsage, "--shard {}: write i/N, for example 0/4 .. 3/4", text);
}

Result<void> run_plan(const RunRequest& request, const CommonOptions& common) {
  const auto started = std::chrono::system_clock::now();
  SPOOL_ASSIGN(NamedCells named, name_cells(request.plan));
  SPOOL_ASSIGN(const std::vector<DumpIdentity> dumps, check_dumps(request.plan));
  SPOOL_ASSIGN(const std::vector<CellStore> others,
               check_merge(request, named, dumps, common.force));
  SPOOL_ASSIGN(CellStore store, prepare_folder(request, named, common.force));
  SPOOL_ASSIGN(std::vector<bool> chosen, chosen_cells(request, named));
  const bool prepares = request.only && request.only->empty();  // for all cells, made elsewhere
  const std::vector<bool> wanted = prepares ? std::vector(named.size(), true) : chosen;
  SPOOL_TRY(check_times(request, named, wanted, store));
  if (store.damaged() > 0) print_warning(store.damage());
  SPOOL_TRY(keep_identities(dumps, request.folder));
  if (!request.merge && store.empty()) SPOOL_TRY(register_claims(request.folder, request.plan));
  SPOOL_TRY(write_text_file(request.folder / "plan.toml", plan_text(request.plan), true, true));
  SPOOL_TRY(merge_folders(request, others, store));
  if (!request.merge)
    SPOOL_TRY(check_input_files(request.folder, request.plan, named, wanted,
                                request.only && !prepares ? nullptr : &store));
  PlanRun run(request, common, std::move(named), std::move(chosen), std::move(store));
  if (!request.merge) SPOOL_TRY(run.run());
  SPOOL_TRY(write_manifest(request, dumps, started));
  return is_part(request) ? run.report_shard() : run.collect();
}

}  // namespace spool::tools
