// The raw sample file of BCD [Bcd]: import and export. Radiance only.
//
// Five i32 (version, width, height, samples, channels), then f32 [y][x][s][c], little-endian; 3
// channels, or 4 of which the last (alpha) is dropped. The format has no magic: that the size is
// exactly what the header says is the only proof. The order of the samples is not recorded.
#pragma once

#include "formats/interchange/export_format.h"
#include "formats/interchange/import_format.h"

namespace spool::interchange {

// Errors: kDamage for a file that is cut, kData for one that is something else.
ImportFormat bcd_format();
// Bit-exact (f16 radiance is widened). Other layers are dropped and named in the report.
ExportFormat bcd_target();

}  // namespace spool::interchange
