// A plan as TOML.
#pragma once

#include <string>

#include "lib/experiment/plan.h"

namespace spool {

// The plan as TOML, in full: parse_plan reads it back to the same cells. Recordings by their
// absolute paths; a path that is no UTF-8 as file:PATH with %XX for its bytes.
std::string plan_text(const Plan& plan);

}  // namespace spool
