#include "tools/batch/exported_inputs.h"

#include <atomic>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>

#include "lib/experiment/plan_text.h"
#include "lib/experiment/run_cells.h"
#include "lib/filters/filter.h"
#include "lib/image_io/atomic_file.h"
#include "lib/pool/load_recording.h"
#include "tools/batch/dump_identity.h"
#include "tools/batch/given_images.h"
#include "tools/batch/run_folder.h"
#include "tools/batch/run_tasks.h"
#include "tools/methods/external_methods.h"
#include "tools/methods/method_memory.h"
#include "tools/methods/replicate_images.h"
#include "tools/methods/statistics_file.h"
#include "tools/terminal/interrupt.h"
#include "tools/terminal/progress.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;

// The samples of the plan: another program makes an image of them.
Plan plan_of_inputs(Plan plan) {
  plan.filters = {MethodChoice{"box", "", {}}};
  plan.title.clear();
  plan.claims.clear();
  plan.baseline.clear();
  plan.energy_band.reset();
  plan.threads = {0};
  plan.experiment.repeats = 1;
  plan.experiment.masks.clear();
  plan.experiment.metrics = {};
  plan.experiment.metrics.perceptual = Perceptual::kNone;
  plan.experiment.metrics.bootstrap.resamples = 0;
  plan.pictures = false;
  return plan;
}

// A folder of these inputs is gone on with; of others, or beside other files, nothing is written.
Result<void> prepare_inputs(const fs::path& folder, const Plan& plan,
                            const std::vector<DumpIdentity>& dumps) {
  std::error_code status;
  const std::string text = plan_text(plan);
  if (fs::exists(folder, status) && !fs::is_empty(folder, status)) {
    std::ifstream file(folder / "plan.toml", std::ios::binary);
    const std::string found((std::istreambuf_iterator<char>(file)), {});
    if (found != text) {
      return fail(ErrorCode::kUsage, "{}: holds {}: choose another folder for these inputs",
                  folder.string(), found.empty() ? "other files" : "inputs of another plan");
    }
  }
  fs::create_directories(folder, status);
  if (status) return fail(ErrorCode::kIo, "{}: {}", folder.string(), status.message());
  SPOOL_TRY(keep_identities(dumps, folder));
  return write_text_file(folder / "plan.toml", text, true, true);
}

// The mean of the samples; writes the statistics of what it is asked for on the way.
ReadyFilter writing_filter(const std::string& pattern, const std::string& replicate,
                           std::atomic<std::size_t>& written) {
  return {[=, &written, letters = std::make_shared<ImageLetters>()](
              const Selection& selection, const SamplePool& pool,
              const FilterContext&) -> Result<Reconstruction> {
            const fs::path path = fill_replicate(pattern, replicate + letters->next(pool));
            std::error_code status;
            if (!fs::exists(path, status)) {
              ToldStatistics told;
              told.features = true;
              SPOOL_TRY(write_statistics(path, selection.statistics, pool, told));
            }
            ++written;
            Reconstruction mean;
            mean.image = make_rgb(pool.recording().width(), pool.recording().height());
            return mean;
          },
          Needs{.features = Use::kWhenRecorded}};
}

// Names in DIR, to be filled in; with {sampler} where the plan has several.
std::string input_names(const Plan& plan) {
  return plan.samplers.size() > 1 ? "{recording}_{sampler}_{spp}_{replicate}.exr"
                                  : "{recording}_{spp}_{replicate}.exr";
}

}  // namespace

Result<void> export_inputs(const RunRequest& request, const CommonOptions& common) {
  const Plan plan = plan_of_inputs(request.plan);
  const fs::path& folder = request.inputs;
  const std::string pattern = (folder / input_names(plan)).string();
  SPOOL_ASSIGN(const std::vector<DumpIdentity> dumps, check_dumps(plan));
  SPOOL_TRY(check_image_names(plan, pattern, "--export-inputs"));
  SPOOL_TRY(prepare_inputs(folder, plan, dumps));
  RunRequest of_inputs = request;
  of_inputs.plan = plan;
  SPOOL_ASSIGN(const NamedCells named, name_cells(plan));
  SPOOL_ASSIGN(const std::vector<bool> chosen, chosen_cells(of_inputs, named));
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < named.size(); ++i) {
    if (!chosen[i]) continue;
    Cell cell = named.cell(i);
    cell.filter = {"image", pattern, {}};
    cells.push_back(with_filled_names(cell));
  }
  SPOOL_ASSIGN(const PlanDemands methods, demands_of(plan.samplers, plan.filters));
  const int pieces = plan.experiment.pieces_per_side;
  const WorkingMemory memory =
      evaluation_memory(methods.samplers, methods.filters, pieces, plan.experiment.halves > 0);
  const SampleFilm film = film_for(methods.samplers, methods.filters, pieces);
  std::atomic<std::size_t> written = 0;
  std::optional<Error> failure;
  std::size_t done = 0;
  const auto cancelled = [&] { return request.cancelled && request.cancelled(); };
  Progress progress("export", common.quiet);
  const InterruptNote note(
      [&] { return fmt::format("{}: the same command goes on from there", folder.string()); });
  run_cells(
      cells, plan.experiment,
      {[&](const std::string& dump) { return load_recording(dump, plan.rules, memory, film); },
       [](const MethodChoice& choice) { return make_method(known_samplers(), choice); },
       [&](const MethodChoice& choice) -> Result<ReadyFilter> {
         return writing_filter(choice.preset, choice.set.back().second, written);
       },
       [&](const RecordedSamples& samples) { return runs_at_once(plan, samples, memory); }},
      {.finished =
           [&](CellResult& result, const CellImages*) {
             ++done;
             if (result.error && !failure) failure = result.error;
           },
       .progress =
           [&](double share) {
             progress.update(share, fmt::format("{} of {} replicates", done, cells.size()));
           },
       .cancelled = cancelled});
  if (failure) return fail(failure->code, "--export-inputs: {}", failure->message);
  if (cancelled()) {
    return fail(ErrorCode::kData, "interrupted; {}: the same command goes on from there",
                folder.string());
  }
  if (common.quiet) return {};
  print_line(fmt::format("inputs: {} images in {}; make one of the same name of each, then",
                         written.load(), folder.string()));
  print_line(fmt::format("  --filters 'box,LABEL=image:YOURS/{}'", input_names(plan)));
  return {};
}

}  // namespace spool::tools
