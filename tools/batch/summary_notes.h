// The lines below the table of `spool evaluate`: what would decide more, what stands on little,
// what loses or gains light, what time commands take, what imports remarked. Each is empty where
// there is nothing to say.
#pragma once

#include <string>

#include "lib/study/study.h"
#include "tools/batch/shown_results.h"

namespace spool::tools {

// The methods that more replicates or recordings would separate from the baseline, the cheapest
// first.
std::string would_decide_text(const ShownResults& shown);
// How many have no verdict and why, and the result that stands on the fewest pixels.
std::string support_text(const ShownResults& shown, bool wide);  // by MSE, too, where wide
std::string light_text(const ShownResults& shown);
// Commands spend time on their start and on files, which is not the method's.
std::string exchange_text(const ShownResults& shown);
// Recordings whose samples were remarked on when they were imported, and how to read the remarks.
std::string imported_text(const Study& study);

}  // namespace spool::tools
