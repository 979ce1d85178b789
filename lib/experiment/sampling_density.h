// Where a sampling run put its samples.
#pragma once

#include <vector>

#include "lib/experiment/sampling_run.h"

namespace spool {

SamplingDensity density_of(const std::vector<SampledPart>& parts);

}  // namespace spool
