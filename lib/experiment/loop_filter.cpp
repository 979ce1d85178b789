#include "lib/experiment/loop_filter.h"

#include <utility>

namespace spool {

LoopFilter loop_filter(const ReadyFilter& filter) {
  return
      [run = filter.run](const Selection& selection, const SamplePool& pool) -> Result<RgbImage> {
        SPOOL_ASSIGN(Reconstruction reconstruction, run(selection, pool, {}));
        return std::move(reconstruction.image);
      };
}

Result<MethodChoice> loop_choice(const Needs& of_sampler, const MethodChoice& of_image) {
  if (of_sampler.loop_filter.empty()) return of_image;
  return parse_method(of_sampler.loop_filter, {});
}

Result<void> check_loop_filter(const MethodChoice& sampler, const Needs& of_sampler,
                               const MethodChoice& filter, const Needs& of_filter) {
  if (!of_sampler.filter_in_loop || !of_filter.reference) return {};
  return fail(
      ErrorCode::kUsage,
      "{} with {}: the sampler has the filter in its loop, and this filter is an oracle: no "
      "sampler may use the reference; leave one of the two out",
      sampler.label(), filter.label());
}

Result<void> check_loop_filters(const MethodList<SamplerFunction>& known_samplers,
                                const std::vector<MethodChoice>& samplers,
                                const MethodList<FilterFunction>& known_filters,
                                const std::vector<MethodChoice>& filters) {
  for (const MethodChoice& sampler : samplers) {
    SPOOL_ASSIGN(const ReadySampler ready, make_method(known_samplers, sampler));
    if (!ready.needs.filter_in_loop) continue;
    Result<void> last;
    bool one_fits = filters.empty();
    for (const MethodChoice& filter : filters) {
      SPOOL_ASSIGN(const MethodChoice choice, loop_choice(ready.needs, filter));
      SPOOL_ASSIGN(const ReadyFilter in_loop, make_method(known_filters, choice));
      last = check_loop_filter(sampler, ready.needs, choice, in_loop.needs);
      one_fits = one_fits || last;
    }
    if (!one_fits) return last;
  }
  return {};
}

}  // namespace spool
