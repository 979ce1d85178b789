// The verbs that make images visible.
#pragma once

#include "tools/command_line/program.h"

namespace spool::tools {

void add_picture(Program& program);
void add_show(Program& program);

}  // namespace spool::tools
