// The tile set of SBMC [Gharbi2019], made by its patched pbrt-v2: import.
//
// One file per square tile: a header of 60 bytes, one LZ4 frame of reference planes, then one frame
// of 27 + 36 float planes and 6 planes of bounce flags per sample index. A set is a folder of
// *.bin, or a .txt list of paths relative to itself. Samples of a pixel are a shuffled (0,2)-set:
// exchangeable, but not independent.
#pragma once

#include "formats/interchange/import_format.h"

namespace spool::interchange {

// Errors: kDamage for frames that do not decode to their size or tiles that are missing, kData for
// headers that do not belong together and sub-pixel positions outside their pixel.
ImportFormat sbmc_format();

}  // namespace spool::interchange
