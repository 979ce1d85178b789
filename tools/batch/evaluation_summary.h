// The table that `spool evaluate` prints: a study, shortened.
#pragma once

#include <string>

#include "lib/study/study.h"

namespace spool::tools {

// Claims first; then one line per scene, budget, sampler, filter and number of threads, best relMSE
// first. Where there are very many, the best of each scene and budget. `wide`: MSE, energy, times,
// and errors at equal time too.
std::string summary_text(const Study& study, bool wide);

}  // namespace spool::tools
