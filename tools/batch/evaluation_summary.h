// The table that `spool evaluate` prints: what statistics.json says, shortened.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace spool::tools {

// Claims first; then one line per scene, budget, sampler, filter and number of threads, best relMSE
// first. Where there are very many, the best of each scene and budget. `wide`: MSE, energy, times,
// and errors at equal time too.
std::string summary_text(const nlohmann::ordered_json& statistics, bool wide);

// The same as a list of objects, always whole.
std::string summary_json(const nlohmann::ordered_json& statistics);

}  // namespace spool::tools
