// PNG files of 8-bit pictures.
//
// The module with OpenImageIO is opened at the first call: SPOOL_PNG_MODULE names it, else
// lib/spool/spool_png.so is looked for beside the executable and one and two folders above it.
#pragma once

#include <filesystem>
#include <vector>

#include "lib/core/error.h"
#include "lib/image_io/picture.h"

namespace spool {

// The contents of such a file.
Result<std::vector<unsigned char>> png_bytes(const Picture& picture);

// Written under a temporary name, then renamed.
Result<void> write_png(const std::filesystem::path& path, const Picture& picture, bool overwrite,
                       bool shared = false);

}  // namespace spool
