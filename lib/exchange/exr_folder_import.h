// A folder of EXR images, one sample of every pixel each; exr_folder_export.h writes it.
//
// Names of channels: exr_names.h; order of the files: numbered_files.h. pixel_layers.exr in the
// folder holds what has one value per pixel (a reference).
#pragma once

#include <filesystem>

#include "formats/interchange/import_format.h"
#include "lib/core/error.h"
#include "lib/exchange/exr_names.h"

namespace spool::exchange {

struct ExrFolderImportOptions : interchange::ImportOptions {
  LayerMap map;
};

// Errors: kData for files of different sizes or channels, files that hold several samples, another
// colour space, gaps, and passes that are all alike; kDamage for files that do not decode.
Result<interchange::ImportReport> import_exr_folder(const std::filesystem::path& in,
                                                    const std::filesystem::path& out,
                                                    const ExrFolderImportOptions& options = {});

interchange::ImportFormat exr_folder_format();

}  // namespace spool::exchange
