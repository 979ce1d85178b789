// The verbs that say what the program is, made from the program's own options.
#pragma once

#include "tools/command_line/program.h"

namespace spool::tools {

// Every value that the option of the verb may have; empty: any.
std::vector<std::string> choices_of(const std::string& verb, const CLI::Option& option);
void add_completion(Program& program);
void add_man(Program& program);

}  // namespace spool::tools
