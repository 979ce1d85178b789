// The verbs about recordings: what is in them, whether they are whole, and where they come from.
#pragma once

#include "tools/command_line/program.h"

namespace spool::tools {

void add_info(Program& program);
void add_check(Program& program);
void add_recover(Program& program);
void add_pack(Program& program);
void add_convert(Program& program);
void add_synth(Program& program);

}  // namespace spool::tools
