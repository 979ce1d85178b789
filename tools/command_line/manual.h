// The verbs that say what the program is, made from the program's own options.
#pragma once

#include "tools/command_line/program.h"

namespace spool::tools {

void add_completion(Program& program);
void add_man(Program& program);

}  // namespace spool::tools
