// Runs a program of Python by an interpreter that has the packages it needs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace spool::tools {

inline constexpr int kPythonNotFound = 127;

// What a program of Python printed, without the line ends behind it, and how it ended.
struct PythonRun {
  std::string python;  // its interpreter
  int exit_code = kPythonNotFound;
  std::string out = {}, err = {};
};
enum class PythonErrors { kKept, kPrinted };  // what it prints there: or where this program does

// Runs Python with these arguments, by the first interpreter that is there and does not end with
// the code `lacks`; else by the last one tried. `input` becomes its standard input. `folder` goes
// with this program, should that be killed.
PythonRun run_python(std::vector<std::string> arguments, int lacks, const std::string& input,
                     PythonErrors errors, const std::filesystem::path& folder = {});

}  // namespace spool::tools
