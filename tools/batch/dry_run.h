// `spool evaluate --dry-run`: the cells of a plan and about how long they will take.
#pragma once

#include "lib/core/error.h"
#include "tools/batch/run_request.h"
#include "tools/terminal/console.h"

namespace spool::tools {

// Prints the cells and about how long they will take, from the cells done in `request.folder`, else
// from a small analytic scene on which every method is tried. Writes nothing.
Result<void> print_dry_run(const RunRequest& request, const CommonOptions& common);

}  // namespace spool::tools
