// A dump as numpy's .npz; npz_import.h says what it looks like.
#pragma once

#include <filesystem>

#include "lib/core/error.h"

namespace spool::interchange {

struct NpzExportOptions {
  bool force = false;  // replace OUT
};

// Layout HWSC, members stored; bit-exact. Errors: kData when blocks are missing in the dump.
Result<void> export_npz(const std::filesystem::path& in, const std::filesystem::path& out,
                        const NpzExportOptions& options = {});

}  // namespace spool::interchange
