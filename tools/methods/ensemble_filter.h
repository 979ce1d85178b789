// `ensemble:a+b[+c+d]`: the mean of filters that are named as anywhere else
// (lib/filters/ensemble.h).
#pragma once

#include <string>
#include <vector>

#include "lib/filters/ensemble.h"
#include "lib/methods/method_list.h"

namespace spool::tools {

// The methods of "oidn+exec:COMMAND", as they are written.
std::vector<std::string> ensemble_parts(const std::string& text);

// Parts of "oidn+twin_guides{energy=box}", of those that are `known`: a + in braces does not part.
// Errors kUsage.
Result<ReadyFilter> make_ensemble_filter(const MethodList<FilterFunction>& known,
                                         const std::string& parts, const OptionValues& set);

}  // namespace spool::tools
