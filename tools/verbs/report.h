// `spool report`: one HTML file from the folder that `spool evaluate` wrote.
//
// The page is made by tools/report/report.py with Python 3 and numpy; this verb finds both, hands
// over what the columns mean, and turns failures into errors of the program.
#pragma once

#include <filesystem>
#include <string>

#include "tools/terminal/console.h"

namespace spool::tools {

struct ReportOptions {
  std::filesystem::path folder;  // holds results.csv
  std::filesystem::path output;  // report.html
  std::string metric;            // empty: relmse
  std::string title;             // empty: the recordings' names
  double max_image_mb = 40.0;
};

Result<void> validate(const ReportOptions& options);
// Errors are those of run_generator (tools/verbs/page_generator.h) and of the script.
Result<void> run_report(const ReportOptions& options, const CommonOptions& common);

// The page for `spool view`: it asks the program that serves it about pixels.
Result<std::string> served_report(const std::filesystem::path& folder);

}  // namespace spool::tools
