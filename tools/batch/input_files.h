// Files that results depend on beside the recordings: masks, counts, images, and those words of a
// command that are files. DIR/inputs.json has their hashes, so that results of a file as it was and
// as it is now are not mixed.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/experiment/plan.h"
#include "tools/batch/cell_store.h"
#include "tools/batch/run_folder.h"

namespace spool::tools {

// Writes inputs.json of the files that the chosen cells depend on. kUsage where one has changed
// since `store` was given a result of it that did not fail; null: since inputs.json was written.
Result<void> check_input_files(const std::filesystem::path& folder, const Plan& plan,
                               const NamedCells& named, const std::vector<bool>& chosen,
                               const CellStore* store);

// What inputs.json of these folders say together, none: empty. kUsage where two of them are of
// another file of one path.
Result<std::string> merged_inputs(const std::filesystem::path& folder,
                                  const std::vector<std::filesystem::path>& others);

}  // namespace spool::tools
