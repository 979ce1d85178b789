// `spool info`: what was recorded.
#pragma once

#include <filesystem>

#include "tools/console.h"

namespace spool::tools {

struct InfoOptions {
  std::filesystem::path dump;
};

Result<void> run_info(const InfoOptions& options, const CommonOptions& common);

}  // namespace spool::tools
