// `spool show`: EXR images beside each other as one HTML file, without a recording.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/show/shown_images.h"
#include "tools/terminal/console.h"

namespace spool::tools {

struct ShowOptions {
  std::vector<std::string> images;  // "FILE" or "NAME=FILE"
  std::filesystem::path reference;  // empty: none
  std::filesystem::path output;     // NAME.html
  std::vector<std::string> crops;   // "X,Y,WIDTH,HEIGHT"
  ShowSettings settings;
};

Result<void> validate(const ShowOptions& options);
Result<void> run_show(const ShowOptions& options, const CommonOptions& common);

}  // namespace spool::tools
