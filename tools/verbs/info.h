// `spool info`: what was recorded.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/terminal/console.h"

namespace spool::tools {

struct InfoOptions {
  std::filesystem::path dump;
  bool all = false;  // every channel, claim and remark, and the hash, for which all bytes are read
};

// The rows that it prints, [what, text], and after them every claim, what "claim".
Result<std::vector<std::vector<std::string>>> recording_facts(const std::filesystem::path& path);

Result<void> run_info(const InfoOptions& options, const CommonOptions& common);

}  // namespace spool::tools
