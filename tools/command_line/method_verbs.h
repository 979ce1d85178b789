// The verbs that run one method on one recording, or show it; and those that make images visible.
#pragma once

#include "tools/command_line/program.h"

namespace spool::tools {

void add_replay(Program& program);
void add_reconstruct(Program& program);
void add_pixel(Program& program);
void add_view(Program& program);
void add_list(Program& program);
void add_picture(Program& program);
void add_show(Program& program);

}  // namespace spool::tools
