// Which claims of a plan were there before its first result: FOLDER/claims.json.
#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

#include "lib/core/error.h"
#include "lib/experiment/plan.h"

namespace spool::tools {

// Keeps the plan's claims where the folder has no finished result yet.
Result<void> register_claims(const std::filesystem::path& folder, const Plan& plan);

// Marks what `statistics` holds and claims.json does not: "after_results": true.
void mark_late_claims(const std::filesystem::path& folder, nlohmann::ordered_json& statistics);

}  // namespace spool::tools
