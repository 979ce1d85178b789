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

inline constexpr int kPythonNotFound = 127;

// What a program of Python printed, without the line ends behind it, and how it ended.
struct PythonRun {
  std::string python;  // its interpreter
  int exit_code = kPythonNotFound;
  std::string out = {}, err = {};
};
enum class PythonErrors { kKept, kPrinted };  // what it prints there: or where this program does

// Runs Python with these arguments, by the first interpreter that is there and does not end with
// the code `lacks`; else by the last one tried. `input` becomes its standard input.
PythonRun run_python(std::vector<std::string> arguments, int lacks, const std::string& input,
                     PythonErrors errors);

// What the script printed: report, figure, live_page or show_page. `input` becomes its standard
// input. kUsage when Python or a package is missing (SPOOL_PYTHON names another interpreter), kIo
// when tools/report/run.py is not beside the program (SPOOL_REPORT names its folder).
Result<std::string> run_generator(const std::string& script, std::vector<std::string> arguments,
                                  const std::string& input, const GeneratorNeeds& needs);

}  // namespace spool::tools
