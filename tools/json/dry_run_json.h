// What `spool evaluate --dry-run --json` prints.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/batch/unused_layers.h"

namespace spool::tools {

struct DryRun {
  std::size_t cells = 0, done = 0, left = 0;
  double seconds = 0;            // for what is left, as far as its time is known
  std::size_t unknown_time = 0;  // of what is left
  std::vector<UnusedLayers> unused;
};
std::string dry_run_text(const DryRun& run);

}  // namespace spool::tools
