// `spool completion` and `spool man`: what the program says of itself, for shells and for man(1).
#pragma once

#include <filesystem>
#include <string>

#include "tools/manual/program_text.h"
#include "tools/terminal/console.h"

namespace spool::tools {

struct CompletionOptions {
  std::string shell;
};

struct ManOptions {
  std::string verb;              // empty: the program's own page
  std::filesystem::path output;  // a folder for all pages; empty: one page to stdout
};

Result<void> run_completion(const CompletionOptions& options, const ProgramText& program);
Result<void> run_man(const ManOptions& options, const CommonOptions& common,
                     const ProgramText& program);

}  // namespace spool::tools
