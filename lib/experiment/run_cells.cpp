#include "lib/experiment/run_cells.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <string>
#include <unordered_map>

#include "lib/core/parallel.h"
#include "lib/core/worker_threads.h"
#include "lib/experiment/cell_judging.h"
#include "lib/experiment/cell_sampling.h"
#include "lib/experiment/recording_in_use.h"

namespace spool {
namespace {

// An exception in one cell, memory that ran out above all, is that cell's error.
template <class Work>
std::invoke_result_t<Work> guarded(Work&& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kIo, "out of memory: use a smaller recording or fewer threads");
  } catch (const std::exception& error) {
    return fail(ErrorCode::kData, "{}", error.what());
  }
}

// Cells of one sampling run, in the order of the work.
struct WorkGroup {
  const std::vector<Cell>* cells;
  std::vector<std::size_t> members;

  const Cell& first() const { return (*cells)[members.front()]; }
  const std::string& dump() const { return first().dump; }
};

// Those that share a recording side by side; otherwise as they came. They point into `cells`.
std::vector<WorkGroup> work_groups(const std::vector<Cell>& cells) {
  std::vector<WorkGroup> groups;
  std::unordered_map<std::string, std::size_t> group_of, dumps;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto [at, fresh] = group_of.try_emplace(sampling_key(cells[i]), groups.size());
    if (fresh) groups.push_back({&cells, {}});
    groups[at->second].members.push_back(i);
    dumps.try_emplace(cells[i].dump, i);
  }
  std::ranges::stable_sort(groups, {},
                           [&](const WorkGroup& group) { return dumps.at(group.dump()); });
  return groups;
}

class Runner {
 public:
  Runner(const std::vector<Cell>& cells, const ExperimentOptions& options,
         const ExperimentSources& sources, const ExperimentCallbacks& callbacks)
      : cells_(cells),
        sources_(sources),
        callbacks_(callbacks),
        repeats_(options.repeats),
        work_{options, sources, callbacks.cancelled ? &is_cancelled_ : nullptr},
        recording_(sources.load) {}

  void run() {
    const std::vector<WorkGroup> groups = work_groups(cells_);
    for (std::size_t begin = 0; begin < groups.size() && !cancelled();) {
      const int at_once = runs_at_once(groups[begin]);
      std::size_t end = begin + 1;
      while (at_once > 1 && end < groups.size() && groups[end].first().threads == 0 &&
             groups[end].dump() == groups[begin].dump()) {
        ++end;
      }
      if (at_once == 1) {
        run_group(groups[begin], {true, [&](double share) { report(share); }});
      } else {
        // All of one recording, which runs_at_once() has loaded.
        for_each_on_threads(end - begin, at_once, [&](std::size_t i) {
          if (!cancelled()) run_group(groups[begin + i], {false, [](double) {}});
        });
      }
      begin = end;
    }
  }

 private:
  int runs_at_once(const WorkGroup& group) {
    const Cell& cell = group.first();
    if (!sources_.runs_at_once || cell.threads != 0 || repeats_ > 1) return 1;
    const auto recording = guarded([&] { return recording_.get(cell.dump); });
    return recording ? std::max(sources_.runs_at_once(**recording), 1) : 1;
  }

  void run_group(const WorkGroup& group, const CellLane& lane) {
    const Cell& first = group.first();
    const ThreadLimit limit(first.threads);
    const Result<ReadySampler> sampler = guarded([&] { return sources_.sampler(first.sampler); });
    const bool by_filter =
        sampler && sampler->needs.filter_in_loop && sampler->needs.loop_filter.empty();
    const auto sample = [&](const Cell& cell) {
      return guarded([&] { return sample_cell(work_, cell, sampler, recording_, lane); });
    };
    Result<SamplingRun> sampling = sample(first);
    for (const std::size_t i : group.members) {
      if (cancelled()) return;
      if (by_filter && i != group.members.front()) sampling = sample(cells_[i]);
      run_cell(cells_[i], sampling, lane);
      report_finished();
    }
  }

  void run_cell(const Cell& cell, const Result<SamplingRun>& sampling, const CellLane& lane) {
    CellResult result;
    result.cell = cell;
    result.alone = lane.alone;
    result.threads = lane.alone ? allowed_threads() : 1;
    const auto shown = [&](const CellImages& images) { finish(result, &images); };
    const Result<void> outcome =
        sampling ? guarded([&] { return judge_cell(work_, *sampling, lane, result, shown); })
                 : tl::unexpected<Error>(sampling.error());
    if (!outcome) {
      result.error = outcome.error();
      finish(result, nullptr);
    }
  }

  void finish(CellResult& result, const CellImages* images) {
    const std::lock_guard lock(callback_);
    result.reading = recording_.take_reading();
    if (callbacks_.finished) callbacks_.finished(result, images);
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

  bool cancelled() {
    const std::lock_guard lock(callback_);
    return callbacks_.cancelled && callbacks_.cancelled();
  }

  const std::vector<Cell>& cells_;
  const ExperimentSources& sources_;
  const ExperimentCallbacks& callbacks_;
  const int repeats_;
  const std::function<bool()> is_cancelled_ = [this] { return cancelled(); };
  const CellWork work_;
  RecordingInUse recording_;
  std::mutex callback_;   // held by the caller of one, and around done_ and the time of reading
  std::size_t done_ = 0;  // cells
};

}  // namespace

void run_cells(const std::vector<Cell>& cells, const ExperimentOptions& options,
               const ExperimentSources& sources, const ExperimentCallbacks& callbacks) {
  Runner(cells, options, sources, callbacks).run();
}

}  // namespace spool
