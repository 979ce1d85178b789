// Which claims of a plan were there before its first result: FOLDER/claims.json.
#pragma once

#include <filesystem>
#include <vector>

#include "lib/core/error.h"
#include "lib/study/claim_findings.h"

namespace spool::tools {

// Keeps the plan's claims, of a folder without a finished result.
Result<void> register_claims(const std::filesystem::path& folder, const Plan& plan);

// Marks what claims.json does not hold.
void mark_late_claims(const std::filesystem::path& folder, std::vector<ClaimFinding>& claims);

}  // namespace spool::tools
