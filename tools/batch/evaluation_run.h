// Runs the cells of a plan into a folder, and makes the results of what is there.
//
// Resumable: cells that are finished in the folder are not done again; cells that failed are tried
// again. The results of a plan are the same bits however often it was interrupted, however many
// machines shared it and with any number of threads; columns of times apart.
#pragma once

#include <filesystem>
#include <string>

#include "lib/core/error.h"
#include "lib/experiment/plan.h"
#include "tools/batch/run_request.h"
#include "tools/terminal/console.h"

namespace spool::tools {

// "i/N", 0 <= i < N.
Result<Shard> parse_shard(const std::string& text);

// Computes DIR/statistics.json of the finished cells anew, and prints the table.
Result<void> write_statistics(const std::filesystem::path& folder, const Plan& plan,
                              const CommonOptions& common, bool wide);

// kData when cells are missing (merge), failed, or gave pixels that are no numbers.
Result<void> run_plan(const RunRequest& request, const CommonOptions& common);

}  // namespace spool::tools
