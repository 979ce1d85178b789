// The SHA-256 of a file: what tells two dumps apart.
#pragma once

#include <filesystem>
#include <string>

#include "lib/core/error.h"

namespace spool::tools {

Result<std::string> sha256_of_file(const std::filesystem::path& path);  // 64 hexadecimal digits

}  // namespace spool::tools
