// `spool pack`: folders of recorded passes become one dump.
#pragma once

#include <filesystem>
#include <vector>

#include "formats/pass_folder.h"
#include "tools/console.h"

namespace spool::tools {

struct PackVerbOptions {
  std::vector<std::filesystem::path> folders;
  std::filesystem::path output;
  format::PackOptions pack;
};

Result<void> run_pack(const PackVerbOptions& options, const CommonOptions& common);

}  // namespace spool::tools
