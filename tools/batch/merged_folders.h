// Results of other folders are taken into one: `spool evaluate --merge --from`.
#pragma once

#include <vector>

#include "lib/core/error.h"
#include "tools/batch/cell_store.h"
#include "tools/batch/dump_identity.h"
#include "tools/batch/run_folder.h"
#include "tools/batch/run_request.h"

namespace spool::tools {

// The cells of `request.merge_from`, in its order; nothing is written. kUsage where a folder is of
// other recordings or input files or (not `force`) has cells that the plan does not have, kData
// where there is nothing to merge.
Result<std::vector<CellStore>> check_merge(const RunRequest& request, const NamedCells& named,
                                           const std::vector<DumpIdentity>& dumps, bool force);
// Copies these cells into `store`, that of the request's folder, and the images beside them.
Result<void> merge_folders(const RunRequest& request, const std::vector<CellStore>& others,
                           CellStore& store);

}  // namespace spool::tools
