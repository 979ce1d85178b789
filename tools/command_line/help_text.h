// What --help and `spool` alone print: an example first, options in groups, lines as wide as the
// terminal.
#pragma once

#include <memory>

#include <CLI/CLI.hpp>

namespace spool::tools {

// The verbs of `app` in their groups, in the order of use.
void group_verbs(CLI::App& app);
// What `spool` alone prints.
std::string greeting(const CLI::App& app);
std::shared_ptr<CLI::FormatterBase> help_formatter();

}  // namespace spool::tools
