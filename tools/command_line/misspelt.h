// CLI11's complaints in one line, with the nearest known name where a word is unknown.
#pragma once

#include <string>

#include "tools/command_line/program.h"

namespace spool::tools {

std::string explain(const CLI::App& app, const CLI::ParseError& error, int count, char** arguments);

}  // namespace spool::tools
