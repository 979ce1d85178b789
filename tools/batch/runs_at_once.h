// How many results of a plan are made beside each other.
#pragma once

#include "lib/core/working_memory.h"
#include "lib/experiment/plan.h"

namespace spool::tools {

// As many as there are threads, where the picture is small and memory allows it; one where a plan
// runs commands of users, with threads and time limits of their own.
// `each`: the memory of one of them.
int runs_at_once(const Plan& plan, const RecordedSamples& recording, const WorkingMemory& each);

}  // namespace spool::tools
