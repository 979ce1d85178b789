// A recording as a folder of EXR images; exr_folder_import.h says what it looks like.
#pragma once

#include "formats/interchange/export_format.h"

namespace spool::exchange {

// sample_0000.exr, ... into the new folder `out`, channels in the recording's own types. What the
// names cannot say is dropped and reported.
interchange::ExportFormat exr_folder_target();

}  // namespace spool::exchange
