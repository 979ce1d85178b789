// The SHA-256 of a file, or of a recording's table of contents [Fips180]: what identifies them.
#pragma once

#include <filesystem>
#include <string>

#include "formats/file_handle.h"
#include "lib/core/error.h"

namespace spool::interchange {

// 64 hexadecimal digits of the whole file, read from front to back.
Result<std::string> sha256_of(const format::FileHandle& file);
Result<std::string> sha256_of(const std::filesystem::path& path);

// The same of file header, index and footer of a recording (formats/spool.md 3.1, 4.5, 3.3), which
// have its uuid and the checksum of every record. Bytes of a record that no longer match their
// checksum show when the record is read, not here. Errors are those of opening it.
Result<std::string> index_sha256_of(const std::filesystem::path& path);

}  // namespace spool::interchange
