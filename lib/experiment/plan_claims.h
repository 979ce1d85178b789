// The claims of a plan, read from its text.
#pragma once

#include "lib/experiment/plan.h"
#include "lib/experiment/toml_reader.h"

namespace spool {

// Adds [[claim]] to a plan whose methods and budgets are known, and asks for fresh samples where a
// claim is about them. Errors kUsage.
Result<void> read_claims(const TomlReader& toml, const toml::table& root, Plan& plan);

}  // namespace spool
