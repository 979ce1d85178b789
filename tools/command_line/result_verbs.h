// The verbs that compare: results, images, folders of results.
#pragma once

#include "tools/command_line/program.h"

namespace spool::tools {

void add_evaluate(Program& program);
void add_metrics(Program& program);
void add_compare(Program& program);
void add_report(Program& program);
void add_figure(Program& program);

}  // namespace spool::tools
