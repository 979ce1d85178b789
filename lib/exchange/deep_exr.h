// Deep OpenEXR [OpenExr]: one deep sample per Monte Carlo sample; export, and import bit for bit.
//
// There is no convention for Monte Carlo samples, so this is our own: one part of deep scanlines,
// channels named and typed as in the recording, Z = spool.index = the number of the sample (a tool
// that sorts by depth changes nothing; flattening stops without alpha instead of returning the
// first sample as if it were a picture). Layers of pass scope are repeated in every pixel, layers
// of pixel scope go to NAME.pixel.exr beside it.
#pragma once

#include "formats/interchange/export_format.h"
#include "formats/interchange/import_format.h"

namespace spool::exchange {

// Errors: kData for compositing images, unequal counts and reordered samples (with their pixel),
// kUsage for foreign files without the option `deep_samples`, kDamage for files that do not decode.
interchange::ImportFormat deep_exr_format();
// kData when blocks are missing or a scanline would pass 2 GiB.
interchange::ExportFormat deep_exr_target();

}  // namespace spool::exchange
