// `spool completion`: the shell learns the program's verbs, options and their values.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/manual/program_text.h"
#include "tools/terminal/console.h"

namespace spool::tools {

const std::vector<std::string>& completion_shells();  // bash, zsh, fish

// The script that the shell reads. Error kUsage: another shell.
Result<std::string> completion_script(const ProgramText& program, std::string_view shell);

struct CompletionOptions {
  std::string shell;
};
Result<void> run_completion(const CompletionOptions& options, const ProgramText& program);

}  // namespace spool::tools
