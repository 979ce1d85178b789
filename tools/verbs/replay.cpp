#include "tools/verbs/replay.h"

#include <chrono>
#include <optional>
#include <utility>

#include "formats/target_watch.h"
#include "lib/core/counted.h"
#include "lib/experiment/decision_split.h"
#include "lib/experiment/loop_filter.h"
#include "lib/image_io/atomic_file.h"
#include "lib/sampling/spending.h"
#include "tools/json/answers_json.h"
#include "tools/methods/method_memory.h"
#include "tools/methods/selection_file.h"
#include "tools/methods/view_files.h"
#include "tools/terminal/progress.h"
#include "tools/verbs/picture_name.h"

namespace spool::tools {
namespace {

std::vector<ViewDescription> views_of(const Sampler& sampler) {
  std::vector<ViewDescription> known = sampler.views;
  known.insert(known.end(), selection_views().begin(), selection_views().end());
  return known;
}

Result<Views> wanted_views(const ReplayOptions& options,
                           const std::vector<ViewDescription>& known) {
  const std::vector<std::string> wanted = split_list(options.views);
  SPOOL_TRY(check_views(wanted, known));
  if (!options.pictures.empty() && wanted.empty()) {
    return fail(
        ErrorCode::kUsage,
        "--pictures {}: pictures of a replay are those of its views: name some with --views",
        options.pictures.string());
  }
  return Views(wanted);
}

}  // namespace

Result<long long> checked_budget(const SamplePool& pool, double spp) {
  const RecordedSamples& recording = pool.recording();
  const long long budget = sample_budget(spp, recording);
  if (budget > pool.total_capacity()) {
    return fail(
        ErrorCode::kData,
        "{}: --spp {} asks for {} samples, the recording has {}: use --spp {} or record more",
        recording.name(), spp, budget, pool.total_capacity(),
        pool.total_capacity() / (static_cast<long long>(recording.width()) *
                                 static_cast<long long>(recording.height())));
  }
  return budget;
}

Result<void> validate(const ReplayOptions& options) {
  SPOOL_TRY(check_bounds("spp", options.spp, kBudget));
  return validate(options.pool);
}

Result<Replayed> replay(const ReplayOptions& options, const LoadRecording& load,
                        const std::function<void(double)>& progress) {
  SPOOL_TRY(validate(options));
  SPOOL_ASSIGN(const Methods methods,
               choose_with_loop_filter(options.sampler, options.filter, options.method));
  const ChosenMethod<SamplerFunction>& chosen = methods.samplers[0];
  if (!methods.filters.empty()) {
    SPOOL_TRY(check_loop_filter(chosen.choice, chosen.ready.needs, methods.filters[0].choice,
                                methods.filters[0].ready.needs));
  }
  const ReadySampler sample = options.decision_split ? split_decisions(chosen.ready) : chosen.ready;
  const std::vector<ViewDescription> known = views_of(*chosen.method);
  SPOOL_ASSIGN(Views views, wanted_views(options, known));
  const int pieces = options.pool.pieces_per_side;
  Demands sampler = demands_of(chosen);
  sampler.needs.loop_filter.clear();  // the one in its loop is methods.filters
  const std::vector<Demands> filters = demands_of(methods.filters);
  const WorkingMemory work =
      with_views(sampling_memory(sampler, filters, pieces), known, views, pieces);
  SPOOL_ASSIGN(const auto recording,
               load(methods.rules, work, film_for({sampler}, filters, pieces), nullptr));
  SPOOL_ASSIGN(SamplePool pool, SamplePool::create(recording, options.pool));
  SPOOL_ASSIGN(const long long budget, checked_budget(pool, options.spp));
  SamplingContext context;
  context.seed = options.pool.seed;
  context.views = &views;
  context.progress = progress;
  if (!methods.filters.empty()) context.filter = loop_filter(methods.filters[0].ready);
  const auto start = std::chrono::steady_clock::now();
  Result<SamplingResult> sampled = sample(pool, budget, context);
  SPOOL_TRY(
      still_intact(recording));  // goes before what a method says about samples that were lost
  SPOOL_ASSIGN(SamplingResult result, std::move(sampled));
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  add_selection_views(result.selection, views);
  GuardCounts guards = recording->guards();
  guards += result.log.guards;
  return Replayed{std::move(pool), std::move(result), std::move(views), guards, seconds.count()};
}

Result<void> run_replay(const ReplayOptions& options, const CommonOptions& common) {
  SPOOL_TRY(validate(options));
  SPOOL_TRY(check_exr_name(options.output));
  SPOOL_TRY(format::refuse_own_input(options.output, options.dump));
  SPOOL_TRY(refuse_existing(options.output, common.force));
  std::optional<Progress> progress;  // from when the recording is there
  SPOOL_ASSIGN(const Replayed done,
               replay(
                   options,
                   [&](const SanitiseRules& rules, const WorkingMemory& work, SampleFilm film,
                       FirstPass* pass) {
                     auto recording = load_recording(options.dump, rules, work, film, pass);
                     progress.emplace("replay " + options.sampler, common.quiet);
                     return recording;
                   },
                   [&](double share) { progress->update(share); }));
  progress.reset();
  SPOOL_TRY(write_selection(options.output, done.sampled.selection,
                            {options.sampler, options.dump.string(), options.pool}, common.force,
                            &done.views));
  if (!options.pictures.empty()) {
    SPOOL_TRY(write_view_pictures(done.views, options.pictures, common.force));
  }
  const SamplingLog& log = done.sampled.log;
  if (common.json) {
    print(replay_text({options.sampler, options.output, done.guards, done.seconds}, log));
  } else if (!common.quiet) {
    print_line(fmt::format("{}: {} taken of {} asked for, {} ran out, {}", options.output.string(),
                           counted(log.spent, "sample"), log.budget,
                           counted(log.saturated_pieces, "piece"), format_seconds(done.seconds)));
  }
  return {};
}

}  // namespace spool::tools
