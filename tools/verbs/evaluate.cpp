#include "tools/verbs/evaluate.h"

#include <algorithm>
#include <utility>

#include "formats/target_watch.h"
#include "lib/experiment/loop_filter.h"
#include "lib/experiment/plan_cells.h"
#include "lib/experiment/plan_reader.h"
#include "tools/batch/cell_store.h"
#include "tools/batch/dry_run.h"
#include "tools/batch/dump_meta.h"
#include "tools/batch/evaluation_run.h"
#include "tools/batch/executor_run.h"
#include "tools/batch/exported_inputs.h"
#include "tools/batch/run_folder.h"
#include "tools/methods/external_methods.h"
#include "tools/verbs/mask_files.h"
#include "tools/verbs/option_bounds.h"

namespace spool::tools {
namespace {

template <class Parse>
auto parse_list(const std::string& text, const Parse& parse)
    -> Result<std::vector<typename decltype(parse(text))::value_type>> {
  std::vector<typename decltype(parse(text))::value_type> values;
  for (const std::string& part : split_list(text)) {
    SPOOL_ASSIGN(const auto value, parse(part));
    values.push_back(value);
  }
  return values;
}

Result<void> choose_baseline(Plan& plan, const EvaluateOptions& options) {
  if (options.baseline.empty()) return {};
  if (const auto known = check_method_name(plan, options.baseline); !known) {
    return fail(ErrorCode::kUsage, "--baseline: {}", known.error().message);
  }
  plan.baseline = options.baseline;
  return {};
}

// Recordings that a recorder made of one scene in one go (`--recordings`) are judged together.
Result<void> group_recordings(Plan& plan) {
  for (const std::string& file : plan.recordings) {
    SPOOL_ASSIGN(const format::SpoolReader reader, format::SpoolReader::open(file));
    plan.groups.push_back(recording_group(reader));
  }
  const std::vector<std::string> found = plan.groups;
  for (std::string& group : plan.groups)
    if (std::ranges::count(found, group) < 2) group.clear();
  if (std::ranges::all_of(plan.groups, &std::string::empty)) plan.groups.clear();
  return {};
}

// Of `--spp 4 8` the 8 is a file.
Result<void> refuse_words_of_lists(const std::filesystem::path& file) {
  std::error_code status;
  const std::string word = file.string();
  const char* list = find_method(known_samplers(), word)  ? "--samplers"
                     : find_method(known_filters(), word) ? "--filters"
                     : parse_number("", word, 0.0, 1e9)   ? "--spp"
                                                          : nullptr;
  if (list == nullptr || std::filesystem::exists(file, status)) return {};
  return fail(ErrorCode::kUsage, "{}: is no file: a list is one word with commas: {} A,{}", word,
              list, word);
}

Result<Plan> plan_of_options(const EvaluateOptions& options) {
  const auto or_default = [](const std::string& text, const char* name) {
    return split_methods(text.empty() ? name : text);
  };
  SPOOL_ASSIGN(Methods methods,
               choose_methods(or_default(options.samplers, "uniform"),
                              or_default(options.filters, "box"), options.methods));
  Plan plan;
  plan.samplers = choices_of(methods.samplers);
  plan.filters = choices_of(methods.filters);
  plan.rules = methods.rules;
  plan.experiment.metrics = methods.metrics;
  for (const auto& file : options.files) {
    SPOOL_TRY(refuse_words_of_lists(file));
    plan.recordings.push_back(file.string());
  }
  SPOOL_ASSIGN(plan.spp, parse_list(options.spp, [](const std::string& text) {
                 return parse_number("--spp", text, kBudget.lowest, kBudget.highest);
               }));
  if (plan.spp.empty()) return fail(ErrorCode::kUsage, "--spp: give budgets, for example 4,8,16");
  if (!options.cell_threads.empty()) {
    SPOOL_ASSIGN(plan.threads, parse_list(options.cell_threads, [](const std::string& text) {
                   return parse_integer("--sweep-threads", text, 0, 1024);
                 }));
    if (plan.threads.empty())
      return fail(ErrorCode::kUsage, "--sweep-threads: give numbers: 1,2,4");
  }
  plan.replicates = options.replicates.value_or(options.recorded_order ? 1 : plan.replicates);
  plan.experiment.halves = plan.measured_halves();
  plan.experiment.repeats = options.repeats.value_or(1);
  plan.experiment.seed = options.seed.value_or(plan.experiment.seed);
  plan.experiment.holdout = options.holdout;
  plan.experiment.order =
      options.recorded_order ? ReplicateOrder::kRecorded : ReplicateOrder::kDisjoint;
  plan.experiment.pieces_per_side = options.pieces_per_side.value_or(1);
  plan.experiment.decision_split = options.decision_split;
  plan.experiment.fresh = options.fresh;
  plan.pictures = !options.no_pictures;
  SPOOL_TRY(choose_baseline(plan, options));
  if (!options.reference.empty()) {
    SPOOL_ASSIGN(plan.experiment.reference, parse_reference_kind(options.reference));
  }
  SPOOL_TRY(check_recording_names(plan));
  SPOOL_TRY(group_recordings(plan));
  return plan;
}

// A plan says everything: options beside it would be a second truth. `instead`: what to do.
Result<void> refuse_options_beside_plan(const EvaluateOptions& options,
                                        const std::string& instead) {
  const std::pair<const char*, bool> given[] = {{"--samplers", !options.samplers.empty()},
                                                {"--filters", !options.filters.empty()},
                                                {"--spp", !options.spp.empty()},
                                                {"--sweep-threads", !options.cell_threads.empty()},
                                                {"--replicates", options.replicates.has_value()},
                                                {"--repeats", options.repeats.has_value()},
                                                {"--preset", !options.methods.preset.empty()},
                                                {"--set", !options.methods.settings.empty()},
                                                {"--reference", !options.reference.empty()},
                                                {"--holdout", options.holdout.has_value()},
                                                {"--seed", options.seed.has_value()},
                                                {"--recorded-order", options.recorded_order},
                                                {"--pieces", options.pieces_per_side.has_value()},
                                                {"--decision-split", options.decision_split},
                                                {"--fresh", options.fresh},
                                                {"--baseline", !options.baseline.empty()}};
  for (const auto& [name, is_given] : given) {
    if (is_given) return fail(ErrorCode::kUsage, "{}: {}", name, instead);
  }
  return {};
}

Result<Plan> plan_of_file(const EvaluateOptions& options) {
  if (options.files.size() > 1) {
    return fail(ErrorCode::kUsage, "{}: give one plan, or recordings", options.files[1].string());
  }
  SPOOL_TRY(refuse_options_beside_plan(
      options,
      fmt::format("belongs into the plan {}: write it there", options.files.front().string())));
  SPOOL_ASSIGN(Plan plan, read_plan(options.files.front(), {known_samplers(), known_filters()}));
  if (options.no_pictures) plan.pictures = false;
  SPOOL_TRY(read_masks(plan));
  return plan;
}

// A limit below the sweep would measure one number of threads under several names.
Result<void> check_sweep(const Plan& plan, const CommonOptions& common) {
  const int most = std::ranges::max(plan.threads);
  if (common.threads == 0 || common.threads >= most) return {};
  return fail(ErrorCode::kUsage, "--threads {}: the sweep goes up to {}: leave --threads out",
              common.threads, most);
}

Result<void> compute_statistics(const EvaluateOptions& options, const CommonOptions& common) {
  EvaluateOptions others = options;
  others.baseline.clear();
  SPOOL_TRY(refuse_options_beside_plan(
      others, "--statistics-only takes all but the baseline from the folder: leave it out"));
  if (!options.output.empty())
    return fail(ErrorCode::kUsage,
                "-o: --statistics-only writes into the folder of results: leave it out");
  for (const auto& folder : options.files) {
    SPOOL_ASSIGN(Plan plan, kept_plan(folder));
    SPOOL_TRY(choose_baseline(plan, options));
    SPOOL_TRY(write_statistics(folder, plan, common, options.wide));
  }
  return {};
}

}  // namespace

Result<void> validate(const EvaluateOptions& options) {
  const auto check = [](const char* name, const std::optional<int>& value, const Bounds& bounds) {
    return value ? check_bounds(name, *value, bounds) : Result<void>();
  };
  SPOOL_TRY(check("replicates", options.replicates, kReplicates));
  SPOOL_TRY(check("repeats", options.repeats, kRepeats));
  SPOOL_TRY(check("holdout", options.holdout, kHoldout));
  SPOOL_TRY(check("pieces", options.pieces_per_side, kPiecesPerSide));
  return options.seed ? check_seed(*options.seed) : Result<void>();
}

Result<void> run_evaluate(const EvaluateOptions& options, const CommonOptions& common) {
  SPOOL_TRY(validate(options));
  if (options.statistics_only) return compute_statistics(options, common);
  bool has_plan = false;
  for (const auto& file : options.files)
    has_plan = has_plan || file.extension() == ".toml";
  RunRequest request;
  SPOOL_ASSIGN(request.plan, has_plan ? plan_of_file(options) : plan_of_options(options));
  if (!options.merge) SPOOL_TRY(check_sweep(request.plan, common));
  SPOOL_TRY(check_loop_filters(known_samplers(), request.plan.samplers, known_filters(),
                               request.plan.filters));
  request.folder = options.output;
  request.exact_timing = options.timing == "exact";
  request.wide = options.wide;
  request.merge = options.merge;
  request.merge_from = options.merge_from;
  if (!options.shard.empty()) {
    SPOOL_ASSIGN(request.shard, parse_shard(options.shard));
  }
  request.inputs = options.inputs;
  if (!options.inputs.empty()) {
    if (!options.output.empty() || options.merge || options.dry_run) {
      return fail(ErrorCode::kUsage,
                  "--export-inputs: writes inputs and no results: leave -o, --merge and --dry-run "
                  "out, and evaluate when the images are there");
    }
    return export_inputs(request, common);
  }
  if (options.dry_run) return print_dry_run(request, common);
  if (!options.executor.empty() && (options.merge || request.shard)) {
    return fail(ErrorCode::kUsage, "--executor does the whole plan: leave --shard and --merge out");
  }
  if (options.output.empty()) return fail(ErrorCode::kUsage, "-o: give the folder for the results");
  // Beside cells it is one that an evaluation kept, else the user's own.
  if (has_plan && !CellStore::is_in(options.output))
    SPOOL_TRY(format::refuse_own_input(options.output / "plan.toml", options.files.front()));
  if (options.merge && request.shard) {
    return fail(ErrorCode::kUsage, "--merge is of all shards: leave --shard out");
  }
  if (!options.merge && !options.merge_from.empty()) {
    return fail(ErrorCode::kUsage, "--from goes with --merge");
  }
  if (!options.executor.empty()) {
    SPOOL_ASSIGN(const bool leads, run_on_workers(request, options.executor, common));
    if (!leads) return {};
    request.merge = true;
  }
  return run_plan(request, common);
}

}  // namespace spool::tools
