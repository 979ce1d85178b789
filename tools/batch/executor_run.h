// A plan on the workers of an executor of Python: the package spool spreads the sampling runs
// (tools/python/spool/on_workers.py).
#pragma once

#include <string>

#include "lib/core/error.h"
#include "tools/batch/run_request.h"
#include "tools/terminal/console.h"

namespace spool::tools {

// Makes what is missing in the folder; its results are made by a merge. False in a process that was
// a worker of another one, which makes them. `executor` is KIND:WHERE as
// the package knows it. Errors are those of the package; kUsage where no Python has it.
Result<bool> run_on_workers(const RunRequest& request, const std::string& executor,
                            const CommonOptions& common);

}  // namespace spool::tools
