// `spool pack`: folders of recorded passes, or a foreign file, become one dump.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "formats/pass_folder.h"
#include "tools/console.h"

namespace spool::tools {

struct PackVerbOptions {
  std::vector<std::filesystem::path> sources;
  std::string from = "passes";  // or npz
  std::string layout;           // of npz without `meta`: HWSC or SHWC
  bool narrow = false;          // of npz: take 64-bit floats
  std::filesystem::path output;
  format::PackOptions pack;
};

Result<void> run_pack(const PackVerbOptions& options, const CommonOptions& common);

}  // namespace spool::tools
