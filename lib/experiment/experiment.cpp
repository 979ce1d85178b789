#include "lib/experiment/experiment.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <unordered_map>
#include <utility>

#include "lib/core/parallel.h"
#include "lib/core/radical_inverse.h"
#include "lib/core/worker_threads.h"
#include "lib/experiment/decision_split.h"
#include "lib/experiment/loop_filter.h"
#include "lib/experiment/peak_memory.h"
#include "lib/experiment/sample_kurtosis.h"
#include "lib/experiment/stage_clock.h"
#include "lib/sampling/spending.h"
#include "lib/statistics/joined_halves.h"

namespace spool {
namespace {

// Equal for cells of one sampling run.
std::string sampling_key(const Cell& cell) {
  return fmt::format("{}\n{}\n{}\n{}\n{}", cell.dump, cell.sampler.text(), cell.spp, cell.replicate,
                     cell.threads);
}

// A recording in use, loaded once for all neighbouring cells that use it.
struct LoadedDump {
  std::string name;
  Result<std::shared_ptr<const RecordedSamples>> samples;
  double kurtosis;
  StageTime reading;  // handed to the first cell; then 0
};

// One sampling run with what its cells are judged by.
struct SampledPart {
  SamplePool pool;
  SamplingResult sampled;
  JudgingReference reference;
  std::optional<HalfSelections> halves;  // where fresh samples are asked for
};

// One part, or with crossfit the two halves of the recording, each judged by the other.
struct SamplingRun {
  std::vector<SampledPart> parts;
  StageTime time;  // of one part
  ReferenceKind kind;
  double kurtosis;  // of the recording's samples
};

ErrorSupport mean_support(const ErrorSupport& a, const ErrorSupport& b) {
  return {0.5 * (a.worst_share + b.worst_share), 0.5 * (a.half_pixels + b.half_pixels),
          0.5 * (a.reference_noise + b.reference_noise)};
}

// The mean of two tables of one size, for the two halves of crossfit; guards and pixels are sums.
MetricTable mean_table(MetricTable a, const MetricTable& b) {
  for (std::size_t m = 0; m < a.values.size(); ++m) {
    a.values[m].value = 0.5 * (a.values[m].value + b.values[m].value);
    std::vector<double>& resampled = a.resampled[m];
    resampled.resize(std::min(resampled.size(), b.resampled[m].size()));
    for (std::size_t s = 0; s < resampled.size(); ++s)
      resampled[s] = 0.5 * (resampled[s] + b.resampled[m][s]);
    a.values[m].standard_error = standard_error_of(resampled);
  }
  a.squared = mean_support(a.squared, b.squared);
  a.relative = mean_support(a.relative, b.relative);
  a.relative_scale = 0.5 * (a.relative_scale + b.relative_scale);
  a.pixels += b.pixels;
  a.excluded_estimate += b.excluded_estimate;
  a.excluded_reference += b.excluded_reference;
  a.failed = a.failed || b.failed;
  a.guards += b.guards;
  return a;
}

PoolOptions pool_options(const ExperimentOptions& options, int replicate, int holdout) {
  PoolOptions pool{options.pieces_per_side, PoolOrder::kShuffled,
                   mix(options.seed, static_cast<std::uint64_t>(replicate)), holdout};
  if (options.order == ReplicateOrder::kRecorded) pool.order = PoolOrder::kRecorded;
  if (options.order == ReplicateOrder::kDisjoint) {
    pool.seed = mix(options.seed, std::uint64_t{0});
    pool.start = radical_inverse(static_cast<unsigned>(replicate));
  }
  return pool;
}

// How many pieces gave how many samples, as of a list of a whole pixel: a half of the recording
// and a quarter of a pixel have lists that are shorter by as much.
std::vector<std::pair<int, long long>> counts_of(const std::vector<SampledPart>& parts) {
  std::map<int, long long> pieces;
  for (const SampledPart& part : parts) {
    const int q = part.pool.pieces_per_side();
    const int scale = static_cast<int>(parts.size()) * q * q;
    for (const int n : part.sampled.selection.statistics.n.pixels())
      ++pieces[n * scale];
  }
  return {pieces.begin(), pieces.end()};
}

class Runner {
 public:
  Runner(const std::vector<Cell>& cells, const ExperimentOptions& options,
         const ExperimentSources& sources, const ExperimentCallbacks& callbacks)
      : cells_(cells), options_(options), sources_(sources), callbacks_(callbacks) {}

  using Keep = std::function<void(std::size_t cell, CellResult&&)>;

  void run(const Keep& keep) {
    const std::vector<Group> groups = work_groups();
    for (std::size_t begin = 0; begin < groups.size() && !cancelled();) {
      const int at_once = runs_at_once(groups[begin]);
      std::size_t end = begin + 1;
      while (at_once > 1 && end < groups.size() && groups[end].first().threads == 0 &&
             groups[end].dump() == groups[begin].dump()) {
        ++end;
      }
      if (at_once == 1) {
        run_group(groups[begin], {true, [&](double share) { report(share); }}, keep);
      } else {
        for_each_on_threads(end - begin, at_once, [&](std::size_t i) {
          if (!cancelled()) run_group(groups[begin + i], {false, [](double) {}}, keep);
        });
      }
      begin = end;
    }
  }

 private:
  using Share = std::function<void(double)>;  // of the work on one cell

  // How a sampling run and its cells go: alone, or beside others.
  struct Lane {
    bool alone = true;
    Share report;
    CpuOf cpu() const { return alone ? CpuOf::kProcess : CpuOf::kThread; }
  };

  // Cells of one sampling run, in the order of the work.
  struct Group {
    const std::vector<Cell>* cells;
    std::vector<std::size_t> members;
    const Cell& first() const { return (*cells)[members.front()]; }
    const std::string& dump() const { return first().dump; }
  };

  // Those that share a recording side by side; otherwise as they came.
  std::vector<Group> work_groups() const {
    std::vector<Group> groups;
    std::unordered_map<std::string, std::size_t> group_of, dumps;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const auto [at, fresh] = group_of.try_emplace(sampling_key(cells_[i]), groups.size());
      if (fresh) groups.push_back({&cells_, {}});
      groups[at->second].members.push_back(i);
      dumps.try_emplace(cells_[i].dump, i);
    }
    std::ranges::stable_sort(groups, {},
                             [&](const Group& group) { return dumps.at(group.dump()); });
    return groups;
  }

  int runs_at_once(const Group& group) {
    const Cell& cell = group.first();
    if (!sources_.runs_at_once || cell.threads != 0 || options_.repeats > 1) return 1;
    const auto recording = guarded([&] { return load(cell.dump); });
    return recording ? std::max(sources_.runs_at_once(**recording), 1) : 1;
  }

  void run_group(const Group& group, const Lane& lane, const Keep& keep) {
    const Cell& first = group.first();
    const ThreadLimit limit(first.threads);
    const Result<ReadySampler> sampler = guarded([&] { return sources_.sampler(first.sampler); });
    const bool by_filter =
        sampler && sampler->needs.filter_in_loop && sampler->needs.loop_filter.empty();
    Result<SamplingRun> sampling = guarded([&] { return sample(first, sampler, lane); });
    for (const std::size_t i : group.members) {
      if (cancelled()) return;
      const Cell& cell = cells_[i];
      if (by_filter && i != group.members.front())
        sampling = guarded([&] { return sample(cell, sampler, lane); });
      CellResult result = filter(cell, sampling, lane);
      report_finished();
      if (keep) keep(i, std::move(result));
    }
  }

  // Of the cell at work, which runs alone.
  void report(double of_cell) {
    const std::lock_guard lock(callback_);
    if (!callbacks_.progress) return;
    callbacks_.progress((static_cast<double>(done_) + of_cell) /
                        static_cast<double>(cells_.size()));
  }
  void report_finished() {
    {
      const std::lock_guard lock(callback_);
      ++done_;
    }
    report(0.0);
  }

  // An exception in one cell, memory that ran out above all, is that cell's error.
  template <class Work>
  static std::invoke_result_t<Work> guarded(Work&& work) {
    try {
      return work();
    } catch (const std::bad_alloc&) {
      return fail(ErrorCode::kIo, "out of memory: use a smaller recording or fewer threads");
    } catch (const std::exception& error) {
      return fail(ErrorCode::kData, "{}", error.what());
    }
  }

  bool cancelled() {
    const std::lock_guard lock(callback_);
    return callbacks_.cancelled && callbacks_.cancelled();
  }

  Result<std::shared_ptr<const RecordedSamples>> load(const std::string& name) {
    if (!dump_ || dump_->name != name) {
      dump_.reset();  // frees the last recording before the next one is read
      const StageClock clock;
      auto samples = sources_.load(name);
      const StageTime reading = clock.elapsed();
      const double kurtosis = samples ? sample_kurtosis(**samples) : 0.0;
      dump_ = LoadedDump{name, std::move(samples), kurtosis, reading};
    }
    return dump_->samples;
  }

  Result<SamplingRun> sample(const Cell& cell, const Result<ReadySampler>& ready,
                             const Lane& lane) {
    SPOOL_ASSIGN(const auto recording, load(cell.dump));
    if (options_.order == ReplicateOrder::kRecorded && cell.replicate > 0) {
      return fail(ErrorCode::kUsage,
                  "order=recorded gives every replicate the same samples: use disjoint, or one "
                  "replicate");
    }
    const ReferenceKind kind = options_.reference.value_or(default_reference_kind(*recording));
    const bool holds_out = kind == ReferenceKind::kHoldout || kind == ReferenceKind::kHoldoutPair;
    int holdout = options_.holdout.value_or(0);
    if (!options_.holdout && holds_out) holdout = default_holdout(*recording);
    const std::uint64_t seed = mix(options_.seed, static_cast<std::uint64_t>(cell.replicate));
    SPOOL_ASSIGN(SamplePool pool,
                 SamplePool::create(recording, pool_options(options_, cell.replicate, holdout)));
    SPOOL_ASSIGN(ReadySampler sampler, ready);
    if (options_.decision_split) sampler = split_decisions(std::move(sampler));
    SamplingContext context;
    context.seed = seed;
    context.progress = [&](double share) { lane.report(0.5 * share); };
    context.cancelled = callbacks_.cancelled ? &is_cancelled_ : nullptr;
    if (sampler.needs.filter_in_loop) {
      SPOOL_ASSIGN(const MethodChoice in_loop, loop_choice(sampler.needs, cell.filter));
      SPOOL_ASSIGN(const ReadyFilter filter, sources_.filter(in_loop));
      SPOOL_TRY(check_loop_filter(cell.sampler, sampler.needs, in_loop, filter.needs));
      context.filter = loop_filter(filter);
    }
    if (lane.alone) reset_peak_memory();
    SamplingRun run{{}, {}, kind, dump_->kurtosis};
    std::vector<SamplePool> pools = {pool};
    if (kind == ReferenceKind::kCrossfit) pools = {pool.half(0), pool.half(1)};
    std::vector<StageTime> times;
    for (std::size_t i = 0; i < pools.size(); ++i) {
      SPOOL_ASSIGN(SamplingResult sampled,
                   timed(options_.repeats, lane.cpu(), times.emplace_back(), [&] {
                     return sampler(pools[i], sample_budget(cell.spp, *recording), context);
                   }));
      SPOOL_ASSIGN(JudgingReference reference,
                   judging_reference(kind, pools[i], pools[pools.size() - 1 - i],
                                     looked_at(sampled.selection)));
      run.parts.push_back({pools[i], std::move(sampled), std::move(reference), std::nullopt});
      if (splits(cell, kind)) SPOOL_TRY(add_halves(run.parts.back(), sampler, context));
    }
    run.time = mean_time(times);
    return run;
  }

  // Halves of the halves of crossfit would say nothing of the mean that is reported.
  bool splits(const Cell& cell, ReferenceKind kind) const {
    const bool measured =
        cell.replicate < options_.halves && options_.order != ReplicateOrder::kRecorded;
    return options_.fresh || (measured && kind != ReferenceKind::kCrossfit);
  }

  Result<void> add_halves(SampledPart& part, const ReadySampler& sampler,
                          const SamplingContext& context) const {
    const long long budget = part.sampled.log.budget;
    const SelectHalf sample = [&](const SamplePool& pool, std::size_t half) -> Result<Selection> {
      SamplingContext of_half = context;
      of_half.seed = mix(context.seed, half);
      of_half.progress = nullptr;
      SPOOL_ASSIGN(SamplingResult sampled, sampler(pool, budget, of_half));
      return std::move(sampled.selection);
    };
    SPOOL_ASSIGN(part.halves, select_halves(part.pool, budget, options_.fresh, sample));
    return {};
  }

  Result<void> judge_split(const SamplingRun& run, const ReadyFilter& filter, FilterContext context,
                           CellResult& result) const {
    context.progress = nullptr;
    std::vector<FreshErrors> fresh;
    for (const SampledPart& part : run.parts) {
      if (!part.halves) return {};
      const bool left_out = run.kind == ReferenceKind::kLeaveSelectedOut;
      SPOOL_ASSIGN(
          HalfErrors errors,
          judge_halves(
              part.pool, *part.halves, part.sampled.selection.statistics.n,
              left_out ? leave_selected_out_reference(part.pool, looked_at(part.pool, *part.halves))
                       : part.reference,
              options_.metrics,
              [&](const Selection& selection, const SamplePool& half) -> Result<RgbImage> {
                SPOOL_ASSIGN(Reconstruction image, filter(selection, half, context));
                return std::move(image.image);
              }));
      if (errors.fresh) fresh.push_back(*errors.fresh);
      if (run.parts.size() == 1) result.halves = std::move(errors.differences);
    }
    if (!fresh.empty()) result.fresh = mean_of(fresh);
    return {};
  }

  // `other`: the half that `pool` is not, with crossfit.
  static Result<JudgingReference> judging_reference(ReferenceKind kind, const SamplePool& pool,
                                                    const SamplePool& other,
                                                    const CountImage& counts) {
    switch (kind) {
      case ReferenceKind::kIndependent:
        return independent_reference(pool.recording());
      case ReferenceKind::kHoldout:
        return holdout_reference(pool);
      case ReferenceKind::kHoldoutPair:
        return holdout_pair_reference(pool);
      case ReferenceKind::kLeaveSelectedOut:
        return leave_selected_out_reference(pool, counts);
      case ReferenceKind::kCrossfit:
        return other_half_reference(other);
      case ReferenceKind::kPool:
        return pool_reference(pool);
    }
    return fail(ErrorCode::kUsage, "unknown reference");
  }

  CellResult filter(const Cell& cell, const Result<SamplingRun>& sampling, const Lane& lane) {
    CellResult result;
    result.cell = cell;
    result.alone = lane.alone;
    result.threads = lane.alone ? allowed_threads() : 1;
    const Result<void> outcome = sampling ? guarded([&] { return judge(*sampling, result, lane); })
                                          : tl::unexpected<Error>(sampling.error());
    if (!outcome) {
      result.error = outcome.error();
      finish(result, nullptr);
    }
    return result;
  }

  void finish(CellResult& result, const CellImages* images) {
    const std::lock_guard lock(callback_);
    if (dump_) result.reading = std::exchange(dump_->reading, StageTime{});
    if (callbacks_.finished) callbacks_.finished(result, images);
  }

  Result<void> judge(const SamplingRun& run, CellResult& result, const Lane& lane) {
    const RecordedSamples& recording = run.parts.front().pool.recording();
    SPOOL_ASSIGN(const ReadyFilter chosen, sources_.filter(result.cell.filter));
    const ReadyFilter filter = average_halves(chosen);
    FilterContext context;
    context.reference = recording.reference() ? &*recording.reference() : nullptr;
    context.progress = [&](double share) { lane.report(0.5 + 0.5 * share); };
    std::vector<Reconstruction> images;
    std::vector<StageTime> times;
    for (const SampledPart& part : run.parts) {
      SPOOL_ASSIGN(Reconstruction image,
                   timed(options_.repeats, lane.cpu(), times.emplace_back(),
                         [&] { return filter(part.sampled.selection, part.pool, context); }));
      SPOOL_TRY(check_size(image.image, recording, result.cell));
      images.push_back(std::move(image));
    }
    result.filtering = mean_time(times);
    for (std::size_t i = 0; i < images.size(); ++i) {
      result.exchange_seconds +=
          (images[i].exchange_seconds + run.parts[i].sampled.log.exchange_seconds) /
          static_cast<double>(images.size());
    }
    if (lane.alone) result.peak_memory = peak_memory();
    const StageClock clock(lane.cpu());
    for (std::size_t i = 0; i < images.size(); ++i) {
      MetricTable table = error_metrics(images[i].image, run.parts[i].reference, options_.metrics);
      result.metrics = i == 0 ? std::move(table) : mean_table(std::move(result.metrics), table);
    }
    SPOOL_TRY(add_masks(images, run, result));
    result.judging = clock.elapsed();
    if (filter.needs.samples) SPOOL_TRY(judge_split(run, filter, context, result));
    result.reference = run.kind;
    result.holdout = run.parts.front().pool.options().holdout;
    result.width = recording.width();
    result.height = recording.height();
    result.pieces_per_side = run.parts.front().pool.pieces_per_side();
    result.recorded_spp = recording.spp();
    result.recorded_kurtosis = run.kurtosis;
    result.counts = counts_of(run.parts);
    result.sampling = run.time;
    result.cost_per_sample = recording.cost_per_sample();
    result.log = run.parts.front().sampled.log;
    result.guards = recording.guards();
    result.guards += result.metrics.guards;
    for (std::size_t i = 0; i < images.size(); ++i) {
      const SamplingLog& log = run.parts[i].sampled.log;
      result.guards += log.guards;
      result.guards += images[i].guards;
      // Of two halves the worse one counts: it says where the recording was too short.
      result.log.spent = std::min(result.log.spent, log.spent);
      result.log.saturated_pieces = std::max(result.log.saturated_pieces, log.saturated_pieces);
    }
    const SampledPart& part = run.parts.front();
    const CellImages shown{images.front().image, part.sampled.selection, images.front(),
                           part.reference};
    finish(result, &shown);
    return {};
  }

  static Result<void> check_size(const RgbImage& image, const RecordedSamples& recording,
                                 const Cell& cell) {
    if (image[0].width() == recording.width() && image[0].height() == recording.height()) return {};
    return fail(ErrorCode::kData,
                "{}: the filter returned {} x {} pixels for a recording of {} x {}",
                cell.filter.label(), image[0].width(), image[0].height(), recording.width(),
                recording.height());
  }

  Result<void> add_masks(const std::vector<Reconstruction>& images, const SamplingRun& run,
                         CellResult& result) const {
    const std::string recording = std::filesystem::path(result.cell.dump).filename().string();
    for (const EnergyMask& mask : options_.masks) {
      if (!mask.recording.empty() && mask.recording != recording) continue;
      MetricValue mean{0.0, 0.0};
      for (std::size_t i = 0; i < images.size(); ++i) {
        SPOOL_ASSIGN(const MetricValue ratio,
                     energy_in_mask(images[i].image, run.parts[i].reference.mean, mask,
                                    options_.metrics.bootstrap));
        mean.value += ratio.value / static_cast<double>(images.size());
        mean.standard_error += ratio.standard_error / static_cast<double>(images.size());
      }
      result.masks.emplace_back(mask.name, mean);
    }
    return {};
  }

  const std::vector<Cell>& cells_;
  const ExperimentOptions& options_;
  const ExperimentSources& sources_;
  const ExperimentCallbacks& callbacks_;
  std::optional<LoadedDump> dump_;  // one at a time: they are large
  std::mutex callback_;             // held by the caller of one, and around done_
  std::size_t done_ = 0;            // cells
  const std::function<bool()> is_cancelled_ = [this] { return cancelled(); };
};

}  // namespace

std::string_view order_name(ReplicateOrder order) {
  switch (order) {
    case ReplicateOrder::kRecorded:
      return "recorded";
    case ReplicateOrder::kShuffled:
      return "shuffled";
    case ReplicateOrder::kDisjoint:
      return "disjoint";
  }
  return "";
}

std::vector<CellResult> run_experiment(const std::vector<Cell>& cells,
                                       const ExperimentOptions& options,
                                       const ExperimentSources& sources,
                                       const ExperimentCallbacks& callbacks) {
  std::vector<std::optional<CellResult>> results(cells.size());
  Runner(cells, options, sources, callbacks).run([&](std::size_t cell, CellResult&& result) {
    results[cell] = std::move(result);
  });
  std::vector<CellResult> finished;
  for (std::optional<CellResult>& result : results) {
    if (result) finished.push_back(std::move(*result));
  }
  return finished;
}

void run_cells(const std::vector<Cell>& cells, const ExperimentOptions& options,
               const ExperimentSources& sources, const ExperimentCallbacks& callbacks) {
  Runner(cells, options, sources, callbacks).run({});
}

}  // namespace spool
