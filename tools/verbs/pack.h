// `spool pack`: folders of recorded passes, or a foreign file, become one recording.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "formats/interchange/expansion.h"
#include "formats/pass_folder.h"
#include "lib/image_io/layer_choice.h"
#include "tools/terminal/console.h"

namespace spool::tools {

struct PackVerbOptions {
  std::vector<std::filesystem::path> sources;
  std::string from = "passes";  // or the name of an import format
  std::filesystem::path output;
  format::PackOptions pack;
  std::vector<std::string> settings;  // "import.OPTION=VALUE" of a foreign format
  LayerChoice layer;                  // of a format that is made of images
  uint64_t max_expansion = interchange::Expansion{}.times;  // the recording against its source
};

Result<void> run_pack(const PackVerbOptions& options, const CommonOptions& common);

}  // namespace spool::tools
