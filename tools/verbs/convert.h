// `spool convert`: a recording becomes a neighbour's file or folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/terminal/console.h"

namespace spool::tools {

struct ConvertOptions {
  std::filesystem::path input;
  std::filesystem::path output;
  std::string to;                     // of lib/exchange/foreign_formats.h
  std::vector<std::string> settings;  // export.OPTION=VALUE, options of that format
};

Result<void> run_convert(const ConvertOptions& options, const CommonOptions& common);

}  // namespace spool::tools
