// `spool check`: every record of a recording verified.
#pragma once

#include <filesystem>

#include "tools/terminal/console.h"

namespace spool::tools {

struct CheckOptions {
  std::filesystem::path dump;
};

// kDamage when anything is lost; what, is printed first.
Result<void> run_check(const CheckOptions& options, const CommonOptions& common);

}  // namespace spool::tools
