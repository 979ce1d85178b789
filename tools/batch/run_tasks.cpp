#include "tools/batch/run_tasks.h"

#include <algorithm>
#include <functional>
#include <map>

#include "formats/spool_reader.h"
#include "lib/core/available_memory.h"
#include "lib/core/worker_threads.h"
#include "tools/batch/cell_store.h"
#include "tools/methods/external_methods.h"

namespace spool::tools {
namespace {

// A larger picture keeps all threads busy by itself.
constexpr long long kSmallPicture = 256 * 256;  // pixels

constexpr double kJudging = 3.0;      // CPU seconds of a megapixel: all metrics of one image
constexpr double kLoopCalls = 4.0;    // of the filter in a sampler's loop
constexpr double kCostSamples = 8.0;  // a pixel, behind Method::cost

// Cost of a megapixel without judging.
double filter_cost(const Cell& cell) {
  const auto* filter = find_method(known_filters(), cell.filter.name);
  return filter ? filter->cost : kUnmeasuredCost;
}

double sampler_cost(const Cell& cell) {
  const auto* sampler = find_method(known_samplers(), cell.sampler.name);
  const double own = sampler ? sampler->cost : kUnmeasuredCost;
  return own * cell.spp / kCostSamples;
}

// The filter that the sampler names itself, or that of the image.
double loop_cost(const Cell& cell) {
  const auto* sampler = find_method(known_samplers(), cell.sampler.name);
  if (!sampler || !sampler->needs.filter_in_loop) return 0.0;
  const auto* named = find_method(known_filters(), sampler->needs.loop_filter);
  return kLoopCalls * (named ? named->cost : filter_cost(cell));
}

// Costs are CPU seconds of a machine of docs/speed.md, from Method::cost and the pictures' sizes;
// the same on every machine that has the recordings. kIo where a recording cannot be read.
Result<std::vector<PlannedRun>> costed_runs(const Plan& plan, const std::vector<Cell>& cells) {
  std::map<std::string, double> megapixels;
  for (const std::string& dump : plan.recordings) {
    SPOOL_ASSIGN(const format::SpoolReader reader, format::SpoolReader::open(dump));
    megapixels[dump] = 1e-6 * reader.header().width * reader.header().height;
  }
  std::vector<PlannedRun> runs = sampling_runs(cells);
  for (PlannedRun& run : runs) {
    double cost = sampler_cost(cells[run.cells.front()]);
    for (const std::size_t i : run.cells)
      cost += filter_cost(cells[i]) + loop_cost(cells[i]) + kJudging;
    run.cost = cost * megapixels.at(run.dump);
  }
  return runs;
}

}  // namespace

Result<std::vector<bool>> chosen_cells(const RunRequest& request, const NamedCells& named) {
  std::vector<bool> chosen(named.size(), !is_part(request));
  for (const std::string& id : request.only.value_or(std::vector<std::string>())) {
    const auto found = named.find(id);
    if (!found) return fail(ErrorCode::kUsage, "cell {}: the plan has none of this name", id);
    chosen[*found] = true;
  }
  if (!request.shard) return chosen;
  SPOOL_ASSIGN(const std::vector<PlannedRun> runs, costed_runs(request.plan, request.plan.cells()));
  const std::vector<int> shares = balanced_shares(runs, request.shard->count);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    for (const std::size_t cell : runs[i].cells)
      chosen[cell] = shares[i] == request.shard->index;
  }
  return chosen;
}

Result<TasksLeft> tasks_left(const RunRequest& request) {
  SPOOL_ASSIGN(const NamedCells named, name_cells(request.plan));
  SPOOL_TRY(check_dumps(request.plan));
  SPOOL_ASSIGN(const CellStore store, CellStore::open(request.folder));
  std::vector<Cell> cells;
  std::vector<std::string> ids;
  for (std::size_t i = 0; i < named.size(); ++i) {
    const auto record = store.read(named.id(i), named.cell(i));
    if (record && !record->text("reference").empty()) continue;
    cells.push_back(named.cell(i));
    ids.push_back(named.id(i));
  }
  SPOOL_ASSIGN(const std::vector<PlannedRun> runs, costed_runs(request.plan, cells));
  TasksLeft found{{}, named.size() - cells.size(), std::ranges::max(request.plan.threads)};
  for (const PlannedRun& run : runs) {
    RunTask task{run.dump, {}, run.cost};
    for (const std::size_t cell : run.cells)
      task.ids.push_back(ids[cell]);
    found.tasks.push_back(std::move(task));
  }
  std::ranges::stable_sort(found.tasks, std::greater(), &RunTask::cost);
  return found;
}

int runs_at_once(const Plan& plan, const RecordedSamples& recording, const WorkingMemory& each) {
  const long long pixels = static_cast<long long>(recording.width()) * recording.height();
  if (pixels > kSmallPicture || std::ranges::any_of(plan.samplers, runs_alone) ||
      std::ranges::any_of(plan.filters, runs_alone)) {
    return 1;
  }
  const double bytes = each.per_pixel * static_cast<double>(pixels) + each.fixed;
  const auto free = available_memory();
  if (!free) return 1;
  const double fit = static_cast<double>(*free) / std::max(bytes, 1.0);
  return static_cast<int>(std::clamp(fit, 1.0, static_cast<double>(allowed_threads())));
}

}  // namespace spool::tools
