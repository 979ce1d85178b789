// `spool list`: the methods, their presets and options, and the metrics, as the library knows them.
#pragma once

#include <string>
#include <vector>

#include "tools/terminal/console.h"

namespace spool::tools {

struct ListOptions {
  std::string what;  // samplers, filters, presets ... or a method's name; empty: an overview
  bool all = false;  // also the options that few need
};

// What can be listed beside single methods.
std::vector<std::string> lists();

Result<void> run_list(const ListOptions& options, const CommonOptions& common);

}  // namespace spool::tools
