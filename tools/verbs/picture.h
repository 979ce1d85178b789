// `spool picture`: any EXR as a PNG to look at, tone-mapped or in false colour with its bar; or all
// pictures of a folder of results.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lib/image_io/layer_choice.h"
#include "tools/terminal/console.h"

namespace spool::tools {

struct PictureOptions {
  std::filesystem::path image;     // or the folder of spool evaluate
  std::filesystem::path output;    // NAME.png; empty: of a folder
  std::optional<double> exposure;  // EV; absent: the log-average luminance becomes middle grey
  std::filesystem::path like;  // takes the automatic exposure from this image; empty: from `image`
  bool false_colour = false;
  std::string channel;  // of false colour; empty: the only one, else the luminance of R, G, B
  std::string range;    // "LOW,HIGH"; empty: smallest and largest value
  bool log = false;
  std::vector<std::string> flip_maps;  // of a folder: of these results, and nothing drawn
  LayerChoice layer;
};

Result<void> validate(const PictureOptions& options);
Result<void> run_picture(const PictureOptions& options, const CommonOptions& common);

}  // namespace spool::tools
