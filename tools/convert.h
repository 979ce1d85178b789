// `spool convert`: a dump becomes a neighbour's file or folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/console.h"

namespace spool::tools {

struct ConvertOptions {
  std::filesystem::path input;
  std::filesystem::path output;
  std::string to;
  std::string names = "plain";      // exr-folder: plain, blender or rgb
  std::vector<std::string> spp;     // oidn: several; bcd-stats: one
  std::filesystem::path selection;  // bcd-stats: an image of counts
  std::string name;                 // oidn
};

// What --to takes.
const std::vector<std::string>& target_formats();

Result<void> run_convert(const ConvertOptions& options, const CommonOptions& common);

}  // namespace spool::tools
