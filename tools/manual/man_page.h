// `spool man`: the program's manual pages, from what its verbs say of themselves.
#pragma once

#include <string>
#include <vector>

#include "tools/manual/program_text.h"

namespace spool::tools {

struct ManPage {
  std::string file;  // "spool-evaluate.1"
  std::string text;  // roff, with the macros of man(7)
};

// spool(1), then spool-VERB(1) of each verb, in the program's order.
std::vector<ManPage> man_pages(const ProgramText& program);

}  // namespace spool::tools
