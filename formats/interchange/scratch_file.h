// A file without a name beside the target: where importers and exporters lay out what does not fit
// memory. It is gone when it is closed, even if the process is killed.
#pragma once

#include <filesystem>

#include "formats/file_handle.h"
#include "lib/core/error.h"

namespace spool::interchange {

Result<format::FileHandle> open_scratch_file(const std::filesystem::path& out);

// kUsage when `out` exists and `force` is not set: asked before hours of unpacking.
Result<void> refuse_existing_target(const std::filesystem::path& out, bool force);

}  // namespace spool::interchange
