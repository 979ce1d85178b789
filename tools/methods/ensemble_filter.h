// `ensemble:a+b[+c+d]`: the mean of filters that are named as anywhere else
// (lib/filters/ensemble.h).
#pragma once

#include <string>

#include "lib/filters/ensemble.h"
#include "tools/methods/external_methods.h"

namespace spool::tools {

// Parts of "oidn+twin_guides{energy=box}": a + in braces does not part. Errors kUsage.
Result<ReadyFilter> make_ensemble_filter(const std::string& parts, const OptionValues& set);

}  // namespace spool::tools
