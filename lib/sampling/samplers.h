// All samplers of the library.
#pragma once

#include "lib/methods/method_list.h"
#include "lib/sampling/sampler.h"

namespace spool {

using SamplerList = MethodList<SamplerFunction>;

const SamplerList& samplers();

}  // namespace spool
