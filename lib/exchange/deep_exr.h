// Deep OpenEXR [OpenExr]: one deep sample per Monte Carlo sample; export, and import bit for bit.
//
// There is no convention for Monte Carlo samples, so this is our own: one part of deep scanlines,
// channels named and typed as in the recording, Z = spool.index = the number of the sample (a tool
// that sorts by depth changes nothing; flattening stops without alpha instead of returning the
// first sample as if it were a picture). Layers of pass scope are repeated in every pixel, layers
// of pixel scope go to NAME.pixel.exr beside it.
#pragma once

#include <filesystem>

#include "formats/interchange/export_format.h"
#include "formats/interchange/import_format.h"
#include "lib/core/error.h"

namespace spool::exchange {

struct DeepImportOptions : interchange::ImportOptions {
  // Take a file of another tool: R, G, B and Z. Its samples may be sorted by depth, so each pixel
  // is shuffled with a fixed seed.
  bool foreign_samples = false;
};

// Errors: kData for compositing images, unequal counts and reordered samples (with their pixel),
// kUsage for foreign files without `foreign_samples`, kDamage for files that do not decode.
Result<interchange::ImportReport> import_deep_exr(const std::filesystem::path& in,
                                                  const std::filesystem::path& out,
                                                  const DeepImportOptions& options = {});

// kData when blocks are missing or a scanline would pass 2 GiB.
Result<interchange::ExportReport> export_deep_exr(const std::filesystem::path& in,
                                                  const std::filesystem::path& out,
                                                  const interchange::ExportOptions& options = {});

interchange::ImportFormat deep_exr_format();
interchange::ExportFormat deep_exr_target();

}  // namespace spool::exchange
