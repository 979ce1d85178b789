// `spool metrics IMAGE REFERENCE`: every metric of one image against another.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/console.h"

namespace spool::tools {

struct MetricsOptions {
  std::filesystem::path image, reference;
  std::filesystem::path variance;     // of the reference's mean, R, G, B; empty: taken as exact
  std::vector<std::string> masks;     // "NAME=FILE": energy ratio where the mask is above 0.5
  std::vector<std::string> settings;  // "OPTION=VALUE" of the metrics
  std::filesystem::path error_map;    // squared error per pixel as EXR; empty: none
};

Result<void> run_metrics(const MetricsOptions& options, const CommonOptions& common);

}  // namespace spool::tools
