// Where a study takes the results of a plan from: the finished cells of its folder.
#pragma once

#include "lib/study/method_results.h"
#include "tools/batch/cell_store.h"

namespace spool::tools {

// Both must outlive what is returned.
StudySources study_sources(const CellStore& store, const Plan& plan);

}  // namespace spool::tools
