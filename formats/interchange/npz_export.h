// A recording as numpy's .npz; npz_import.h says what it looks like.
#pragma once

#include "formats/interchange/export_format.h"

namespace spool::interchange {

// Layout HWSC, members stored; bit-exact. Errors: kData when blocks are missing in the recording.
ExportFormat npz_target();

}  // namespace spool::interchange
