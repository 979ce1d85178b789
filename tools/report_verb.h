// `spool report`: one HTML file from the folder that `spool evaluate` wrote.
//
// The page is made by tools/report/report.py with Python 3 and numpy; this verb finds both, hands
// over what the columns mean, and turns failures into errors of the program.
#pragma once

#include <filesystem>
#include <string>

#include "tools/console.h"

namespace spool::tools {

struct ReportOptions {
  std::filesystem::path folder;  // holds results.csv
  std::filesystem::path output;  // report.html
  std::string metric;            // empty: relmse
  std::string title;             // empty: the recordings' names
  double max_image_mb = 40.0;
};

// kUsage when Python or numpy is missing (SPOOL_PYTHON names another interpreter), kIo when the
// generator is not beside the program (SPOOL_REPORT names its folder).
Result<void> run_report(const ReportOptions& options, const CommonOptions& common);

}  // namespace spool::tools
