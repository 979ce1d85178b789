// `spool recover`: all intact records of a cut or damaged recording, in a new complete file.
#pragma once

#include <filesystem>

#include "tools/terminal/console.h"

namespace spool::tools {

struct RecoverOptions {
  std::filesystem::path input, output;
};

// kDamage when anything was lost; what, is printed first.
Result<void> run_recover(const RecoverOptions& options, const CommonOptions& common);

}  // namespace spool::tools
