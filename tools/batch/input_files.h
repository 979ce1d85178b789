// Files that results depend on beside the recordings: masks, counts, images, and those words of a
// command that are files. DIR/inputs.json has their hashes, so that results of a file as it was and
// as it is now are not mixed.
#pragma once

#include <filesystem>
#include <vector>

#include "lib/core/error.h"
#include "lib/experiment/plan.h"
#include "tools/batch/cell_store.h"
#include "tools/batch/run_folder.h"

namespace spool::tools {

// Writes inputs.json of the files that the chosen cells depend on. kUsage where one has changed
// since `store` was given a result of it that did not fail.
Result<void> check_input_files(const std::filesystem::path& folder, const Plan& plan,
                               const NamedCells& named, const std::vector<bool>& chosen,
                               const CellStore& store);

}  // namespace spool::tools
