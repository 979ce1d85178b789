// A recording as numpy's .npz; npz_import.h says what it looks like.
#pragma once

#include <filesystem>

#include "formats/interchange/export_format.h"
#include "lib/core/error.h"

namespace spool::interchange {

// Layout HWSC, members stored; bit-exact. Errors: kData when blocks are missing in the recording.
Result<ExportReport> export_npz(const std::filesystem::path& in, const std::filesystem::path& out,
                                const ExportOptions& options = {});

ExportFormat npz_target();

}  // namespace spool::interchange
