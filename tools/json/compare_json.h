// What `spool compare --json` prints.
#pragma once

#include <string>

#include "tools/batch/result_changes.h"

namespace spool::tools {

std::string comparisons_text(const Comparisons& comparisons);

}  // namespace spool::tools
