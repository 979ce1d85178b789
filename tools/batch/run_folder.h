// The folder that a plan's results go to: its cells, and what is checked before hours of work.
#pragma once

#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/experiment/plan.h"
#include "tools/batch/dump_identity.h"
#include "tools/batch/run_request.h"

namespace spool::tools {

// The cells of a plan with their names.
struct NamedCells {
  std::vector<Cell> cells;
  std::vector<std::string> ids;
};

// kUsage when two cells would have one name.
Result<NamedCells> name_cells(const Plan& plan);

// kData when a recording cannot give what the plan asks of it, or is not like others of its group.
Result<void> check_dumps(const Plan& plan);

// A folder of ours is continued, unfinished files of killed runs removed; a strange one is not
// touched (kUsage).
Result<void> prepare_folder(const RunRequest& request, const NamedCells& named, bool force);

// Copies cells and images of `request.merge_from`, which must come from the same recordings.
Result<void> merge_folders(const RunRequest& request, const std::vector<DumpIdentity>& dumps);

}  // namespace spool::tools
