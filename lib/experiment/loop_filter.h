// A filter as samplers with a filter in their loop know it: a selection goes in, an image comes
// out.
#pragma once

#include <vector>

#include "lib/filters/filter.h"
#include "lib/methods/method_list.h"
#include "lib/sampling/sampler.h"

namespace spool {

// Without views and without a reference, which no sampler may have.
LoopFilter loop_filter(const ReadyFilter& filter);

// The filter in the loop of a sampler: the one that it names, else that of the image.
Result<MethodChoice> loop_choice(const Needs& of_sampler, const MethodChoice& of_image);

// kUsage when `sampler` would have `filter` in its loop and `filter` needs the reference: no cell
// of the two can succeed.
Result<void> check_loop_filter(const MethodChoice& sampler, const Needs& of_sampler,
                               const MethodChoice& filter, const Needs& of_filter);

// The same of a sampler that a plan gives nothing but such filters. Beside others, the cells of the
// two fail with the reason, and the rest of the plan is done.
Result<void> check_loop_filters(const MethodList<SamplerFunction>& known_samplers,
                                const std::vector<MethodChoice>& samplers,
                                const MethodList<FilterFunction>& known_filters,
                                const std::vector<MethodChoice>& filters);

}  // namespace spool
