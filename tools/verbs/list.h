// `spool list`: the methods, their presets and options, and the metrics, as the library knows them.
#pragma once

#include <string>

#include "tools/terminal/console.h"

namespace spool::tools {

struct ListOptions {
  std::string what;  // samplers, filters, presets, views, metrics ...; empty: an overview
  bool all = false;  // also the options that few need
};

Result<void> run_list(const ListOptions& options, const CommonOptions& common);

}  // namespace spool::tools
