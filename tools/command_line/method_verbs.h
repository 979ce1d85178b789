// The verbs that run one method on one recording, or show it.
#pragma once

#include "tools/command_line/program.h"

namespace spool::tools {

void add_replay(Program& program);
void add_reconstruct(Program& program);
void add_pixel(Program& program);
void add_view(Program& program);
void add_list(Program& program);

}  // namespace spool::tools
