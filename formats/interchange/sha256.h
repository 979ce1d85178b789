// The SHA-256 of a file [Fips180]: what identifies a file.
#pragma once

#include <filesystem>
#include <string>

#include "formats/file_handle.h"
#include "lib/core/error.h"

namespace spool::interchange {

// 64 hexadecimal digits of the whole file, read from front to back.
Result<std::string> sha256_of(const format::FileHandle& file);
Result<std::string> sha256_of(const std::filesystem::path& path);

}  // namespace spool::interchange
