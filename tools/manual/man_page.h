// `spool man`: the program's manual pages, from what its verbs say of themselves.
#pragma once

#include <filesystem>
#include <string>

#include "tools/manual/program_text.h"
#include "tools/terminal/console.h"

namespace spool::tools {

struct ManOptions {
  std::string verb;              // empty: the program's own page
  std::filesystem::path output;  // a folder for all pages; empty: one page to stdout
};

Result<void> run_man(const ManOptions& options, const CommonOptions& common,
                     const ProgramText& program);

}  // namespace spool::tools
