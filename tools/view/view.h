// `spool view`: the page of a recording or of an evaluation, served to this machine only, so that
// any budget is replayed and any pixel answers while one looks.
#pragma once

#include <filesystem>
#include <string>

#include "tools/terminal/console.h"

namespace spool::tools {

struct ViewOptions {
  std::filesystem::path target;   // a recording, or a folder of results
  int port = 0;                   // 0: any
  bool allow_commands = false;    // of the plan in the folder
  std::string samplers, filters;  // beside those of the target, as spool evaluate takes them
};

Result<void> validate(const ViewOptions& options);
// Serves until the process is interrupted.
Result<void> run_view(const ViewOptions& options, const CommonOptions& common);

}  // namespace spool::tools
