#include "tools/batch/dry_run.h"

#include <algorithm>
#include <chrono>

#include "formats/spool_reader.h"
#include "lib/core/counted.h"
#include "lib/core/visible_text.h"
#include "lib/experiment/plan_cells.h"
#include "lib/experiment/result_table.h"
#include "lib/experiment/run_cells.h"
#include "lib/synthetic/scene_s.h"
#include "tools/batch/cell_store.h"
#include "tools/batch/run_folder.h"
#include "tools/batch/run_tasks.h"
#include "tools/batch/time_estimate.h"
#include "tools/batch/unused_layers.h"
#include "tools/json/answers_json.h"
#include "tools/methods/external_methods.h"

namespace spool::tools {
namespace {

constexpr int kTrialSide = 64;        // pixels of the scene on which methods are tried
constexpr int kTrialSamples = 64;     // recorded samples per pixel
constexpr double kTrialSpp = 8;       // spent
constexpr double kTrialSeconds = 10;  // at most, for all of them

// Commands of users are not run to see how long they take.
bool runs_foreign_code(const Cell& cell) {
  return is_foreign_code(cell.sampler) || is_foreign_code(cell.filter);
}

// Every sampler and every filter of the plan once, on a small analytic scene.
void try_methods(Plan plan, TimeEstimate& estimate) {
  std::erase_if(plan.samplers, is_foreign_code);
  std::erase_if(plan.filters, is_foreign_code);
  if (plan.samplers.empty()) plan.samplers.push_back(MethodChoice{"uniform", "", {}});
  if (plan.filters.empty()) plan.filters.push_back(MethodChoice{"box", "", {}});
  std::vector<Cell> trials;
  const std::size_t n = std::max(plan.samplers.size(), plan.filters.size());
  for (std::size_t i = 0; i < n; ++i) {
    trials.push_back({"trial", plan.samplers[i % plan.samplers.size()],
                      plan.filters[i % plan.filters.size()], kTrialSpp, 0});
  }
  const auto recording = std::make_shared<const RecordedSamples>(
      make_scene_s(kTrialSide, kTrialSide, kTrialSamples, 1));
  const ExperimentSources sources{
      [&](const std::string&) { return Result<std::shared_ptr<const RecordedSamples>>(recording); },
      [](const MethodChoice& choice) { return make_method(known_samplers(), choice); },
      [](const MethodChoice& choice) { return make_method(known_filters(), choice); }};
  const auto start = std::chrono::steady_clock::now();
  ExperimentOptions options = plan.experiment;
  options.pieces_per_side = 1;
  options.reference.reset();
  options.masks.clear();
  const ExperimentCallbacks callbacks{.finished =
                                          [&](CellResult& result, const CellImages*) {
                                            if (!result.error)
                                              estimate.learn(result.cell, record_of(result));
                                          },
                                      .progress = {},
                                      .cancelled =
                                          [&] {
                                            const std::chrono::duration<double> taken =
                                                std::chrono::steady_clock::now() - start;
                                            return taken.count() > kTrialSeconds;
                                          }};
  run_cells(trials, options, sources, callbacks);
}

struct Listing {
  std::size_t all = 0;  // of this shard
  std::vector<Cell> left;
  std::vector<std::pair<Cell, ResultRecord>> done;
  std::string text;  // a line for each
};

Result<Listing> list_cells(const RunRequest& request, bool force) {
  const Plan& plan = request.plan;
  SPOOL_ASSIGN(const CellStore store, CellStore::open(request.folder));
  Listing found;
  SPOOL_ASSIGN(const NamedCells named, name_cells(plan));
  SPOOL_ASSIGN(const std::vector<bool> chosen, chosen_cells(request, named));
  if (!force) SPOOL_TRY(check_times(request, named, chosen, store));
  for (std::size_t i = 0; i < named.size(); ++i) {
    if (!chosen[i]) continue;
    const Cell cell = named.cell(i);
    const std::string id = named.id(i);
    ++found.all;
    auto record = request.folder.empty() ? fail(ErrorCode::kIo, "no folder") : store.read(id, cell);
    const bool is_done = record && !record->text("reference").empty();
    if (is_done) {
      found.done.emplace_back(cell, std::move(*record));
    } else {
      found.left.push_back(cell);
    }
    found.text +=
        visible_text(fmt::format(
            "{}  {}  {} + {}  {:g} spp  replicate {}{}{}", id, cell.dump, cell.sampler.label(),
            cell.filter.label(), cell.spp, cell.replicate,
            cell.threads > 0 ? "  " + counted(static_cast<std::size_t>(cell.threads), "thread")
                             : "",
            is_done ? "  done" : "")) +
        "\n";
  }
  return found;
}

void print_listing(const RunRequest& request, const Listing& cells, std::size_t cells_left) {
  const Plan& plan = request.plan;
  print(cells.text);
  print(fmt::format(
      "\n{}: {} x {} x {} x {} x {} x {}{}; {} done, {} left\n", counted(cells.all, "cell"),
      counted(plan.recordings.size(), "recording"), counted(plan.samplers.size(), "sampler"),
      counted(plan.spp.size(), "budget"),
      counted(static_cast<std::size_t>(plan.replicates), "replicate"),
      plan.threads.size() == 1 ? "1 number of threads"
                               : fmt::format("{} numbers of threads", plan.threads.size()),
      counted(plan.filters.size(), "filter"),
      request.shard ? fmt::format(", shard {}/{}", request.shard->index, request.shard->count) : "",
      cells.done.size(), cells_left));
}

}  // namespace

Result<void> print_dry_run(const RunRequest& request, const CommonOptions& common) {
  const Plan& plan = request.plan;
  SPOOL_TRY(check_dumps(plan));
  std::map<std::string, double> pixels;
  for (const std::string& dump : plan.recordings) {
    SPOOL_ASSIGN(const format::SpoolReader reader, format::SpoolReader::open(dump));
    pixels[dump] = static_cast<double>(reader.header().width) * reader.header().height;
  }
  SPOOL_ASSIGN(Listing cells, list_cells(request, common.force));
  const bool measured = !cells.done.empty();
  std::vector<Cell>& left = cells.left;
  const std::size_t cells_left = left.size();
  if (!measured) std::erase_if(left, runs_foreign_code);
  const std::size_t not_known = cells_left - left.size();
  TimeEstimate estimate(left, [&](const std::string& dump) { return pixels.at(dump); });
  for (const auto& [cell, record] : cells.done)
    estimate.learn(cell, record);
  if (!measured && !left.empty()) try_methods(plan, estimate);
  // The trial cannot see what the machine's caches will make of a large image, nor the writing of
  // pictures; half and twice the estimate are ordinary.
  const double seconds = estimate.seconds_left() * plan.experiment.repeats;
  const std::vector<UnusedLayers> unused = unused_layers(plan);
  if (common.json) {
    print(dry_run_text({cells.all, cells.done.size(), cells_left, seconds, not_known, unused}));
    return {};
  }
  print_listing(request, cells, cells_left);
  if (not_known > 0) {
    print(
        fmt::format("{} of them run commands of the plan (exec:), which a dry run does not: their "
                    "time is not known\n",
                    not_known));
  }
  print(unused_layers_text(unused));
  if (cells_left == 0) {
    print("nothing is left to do\n");
  } else if (!left.empty() && !estimate.known()) {
    print("the time cannot be estimated: no method ran on the trial scene\n");
  } else if (!left.empty()) {
    print(fmt::format("{}about {} ({}); half or twice that is ordinary\n",
                      not_known > 0 ? "the others take " : "", format_seconds(seconds),
                      measured ? "from the results that are done"
                               : "from a trial of each method on a small scene, pictures not "
                                 "counted"));
  }
  return {};
}

}  // namespace spool::tools
