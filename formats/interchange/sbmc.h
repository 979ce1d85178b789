// The tile set of SBMC [Gharbi2019], made by its patched pbrt-v2: import.
//
// One file per square tile: a header of 60 bytes, one LZ4 frame of reference planes, then one frame
// of 27 + 36 float planes and 6 planes of bounce flags per sample index. A set is a folder of
// *.bin, or a .txt list of paths relative to itself. Samples of a pixel are a shuffled (0,2)-set:
// exchangeable, but not independent.
#pragma once

#include <filesystem>
#include <optional>

#include "formats/interchange/import_format.h"
#include "lib/core/error.h"

namespace spool::interchange {

// Distances were divided by ten times the scene's radius ("normalised") or not ("raw"). Without an
// answer it is taken from the light pdfs, which are logarithms in the first case.
enum class SbmcScale { kNormalised, kRaw };

struct SbmcImportOptions : ImportOptions {
  std::optional<SbmcScale> scale;
};

// Errors: kDamage for frames that do not decode to their size or tiles that are missing, kData for
// headers that do not belong together and sub-pixel positions outside their pixel.
Result<ImportReport> import_sbmc(const std::filesystem::path& in, const std::filesystem::path& out,
                                 const SbmcImportOptions& options = {});

ImportFormat sbmc_format();

}  // namespace spool::interchange
