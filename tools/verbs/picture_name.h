// Names of image files that say what is in them: an EXR under the name of a PNG helps no one.
#pragma once

#include <filesystem>

#include "lib/core/error.h"

namespace spool::tools {

bool is_png_name(const std::filesystem::path& path);

// kUsage when the name is one of a picture format other than OpenEXR.
Result<void> check_exr_name(const std::filesystem::path& path);

}  // namespace spool::tools
