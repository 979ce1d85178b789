// Runs the Python scripts of tools/report: finds an interpreter that has what they need, and turns
// failures into errors of the program.
#pragma once

#include <string>
#include <vector>

#include "lib/core/error.h"

namespace spool::tools {

struct GeneratorNeeds {
  std::string verb;      // "spool report"
  std::string packages;  // "numpy"
  std::string debian;    // "python3-numpy"
};

// What the script printed: report, figure, live_page or show_page. `input` becomes its standard
// input. kUsage when Python or a package is missing (SPOOL_PYTHON names another interpreter), kIo
// when tools/report/run.py is not beside the program (SPOOL_REPORT names its folder).
Result<std::string> run_generator(const std::string& script, std::vector<std::string> arguments,
                                  const std::string& input, const GeneratorNeeds& needs);

}  // namespace spool::tools
