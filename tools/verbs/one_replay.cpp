#include "tools/verbs/one_replay.h"

#include "lib/experiment/decision_split.h"
#include "lib/experiment/loop_filter.h"
#include "lib/filters/filters.h"
#include "tools/verbs/replay.h"

namespace spool::tools {

Result<SamplingResult> sample_once(const ReplayMethods& methods, const SamplePool& pool, double spp,
                                   const std::function<bool()>* cancelled) {
  SPOOL_ASSIGN(const long long budget, checked_budget(pool, spp));
  SamplingContext context;
  context.seed = pool.options().seed;
  context.cancelled = cancelled;
  const Needs& needs = methods.sampler.needs;
  if (needs.filter_in_loop) {
    SPOOL_ASSIGN(const MethodChoice choice, loop_choice(needs, methods.filter_choice));
    const bool own = needs.loop_filter.empty() && methods.filter.run;
    SPOOL_ASSIGN(const ReadyFilter filter,
                 own ? Result<ReadyFilter>(methods.filter) : make_method(filters(), choice));
    SPOOL_TRY(check_loop_filter(methods.sampler_choice, needs, choice, filter.needs));
    context.filter = loop_filter(filter);
  }
  return methods.sampler(pool, budget, context);
}

Result<Reconstruction> filter_once(const ReplayMethods& methods, const Selection& selection,
                                   const SamplePool& pool, Footprints* footprints) {
  const auto& reference = pool.recording().reference();
  FilterContext context;
  context.reference = reference ? &*reference : nullptr;
  context.footprints = footprints;
  return average_halves(methods.filter)(selection, pool, context);
}

}  // namespace spool::tools
