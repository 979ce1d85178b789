// The EXR images of a folder in the order of the last number in their names.
//
// Numbers may be negative, padded or not, and of any length. A '-' before the number is a sign at
// the start of the name, after one of "_ .-", and where another name of the folder differs by it
// only (a-1, a0, a1); else it separates. The ending counts in any letter case. Hidden files (macOS
// writes ._NAME beside NAME), folders and other endings are left out, which a note says.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lib/core/error.h"

namespace spool::exchange {

struct NumberedFiles {
  std::vector<std::filesystem::path> paths;  // without gaps, at least one
  std::vector<std::string> notes;            // one line each, for the user
};

// `except`: a file name that is no sample. Errors: kIo for a folder that cannot be listed, kData
// for names without a number, numbers there twice, gaps, and more than format::kMaxSpp images.
Result<NumberedFiles> numbered_files(const std::filesystem::path& in, const std::string& except);

}  // namespace spool::exchange
