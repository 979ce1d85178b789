// A filter as samplers with a filter in their loop know it: a selection goes in, an image comes
// out.
#pragma once

#include "lib/filters/filter.h"
#include "lib/sampling/sampler.h"

namespace spool {

// Without views and without a reference, which no sampler may see.
LoopFilter loop_filter(const ReadyFilter& filter);

}  // namespace spool
