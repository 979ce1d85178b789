// `spool check`: every record of a recording verified; and `spool recover`: all intact records of a
// cut or damaged recording, in a new complete file.
#pragma once

#include <filesystem>

#include "tools/terminal/console.h"

namespace spool::tools {

struct CheckOptions {
  std::filesystem::path dump;
};

struct RecoverOptions {
  std::filesystem::path input, output;
};

// kDamage when anything is lost; what, is printed first.
Result<void> run_check(const CheckOptions& options, const CommonOptions& common);
Result<void> run_recover(const RecoverOptions& options, const CommonOptions& common);

}  // namespace spool::tools
