// The table that `spool evaluate` prints: what statistics.json says, shortened.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace spool::tools {

// One line per scene, budget, sampler, filter and number of threads, best relMSE first, with the
// letters of its rank. Where there are very many, the best of each scene and budget.
std::string summary_text(const nlohmann::ordered_json& statistics);

// The same as a list of objects, always whole.
std::string summary_json(const nlohmann::ordered_json& statistics);

}  // namespace spool::tools
