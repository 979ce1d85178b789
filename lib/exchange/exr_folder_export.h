// A recording as a folder of EXR images; exr_folder_import.h says what it looks like.
#pragma once

#include <filesystem>

#include "formats/interchange/export_format.h"
#include "lib/core/error.h"

namespace spool::exchange {

enum class ExrNames {
  kPlain,    // R, G, B and LAYER.COMPONENT, as OpenImageIO names them; comes back as it was
  kBlender,  // ViewLayer.Combined.R, ViewLayer.DiffCol.R, ...
  kRgb,      // R, G, B only
};

struct ExrFolderExportOptions : interchange::ExportOptions {
  ExrNames names = ExrNames::kPlain;
};

// sample_0000.exr, ... into the new folder `out`, channels in the recording's own types. What the
// names cannot say is dropped and reported.
Result<interchange::ExportReport> export_exr_folder(const std::filesystem::path& in,
                                                    const std::filesystem::path& out,
                                                    const ExrFolderExportOptions& options = {});

interchange::ExportFormat exr_folder_target();

}  // namespace spool::exchange
