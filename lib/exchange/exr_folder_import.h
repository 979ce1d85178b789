// A folder of EXR images, one sample of every pixel each; exr_folder_export.h writes it.
//
// Names of channels: exr_names.h; order of the files: numbered_files.h. pixel_layers.exr in the
// folder holds what has one value per pixel (a reference).
#pragma once

#include "formats/interchange/import_format.h"

namespace spool::exchange {

// Errors: kData for files of different sizes or channels, files that hold several samples, another
// colour space, gaps, and passes that are all alike; kDamage for files that do not decode.
interchange::ImportFormat exr_folder_format();

}  // namespace spool::exchange
