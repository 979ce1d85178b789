// Reads a plan (plan.h) from TOML.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "lib/experiment/plan.h"
#include "lib/experiment/plan_methods.h"

namespace spool {

// Errors: kIo when the file cannot be read, kUsage for everything that is wrong in it.
Result<Plan> read_plan(const std::filesystem::path& path, const PlanVocabulary& vocabulary);
// `name` is for messages, `folder` what recordings are relative to.
Result<Plan> parse_plan(std::string_view text, const std::string& name,
                        const std::filesystem::path& folder, const PlanVocabulary& vocabulary);

}  // namespace spool
