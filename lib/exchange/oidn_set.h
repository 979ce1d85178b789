// Images as Open Image Denoise's tools and trainer [Oidn] name them: export.
//
// NAME_0008spp.hdr.exr, .alb.exr and .nrm.exr for each sample count, and NAME_ref.hdr.exr (.alb,
// .nrm of all samples): means of the first samples of each pixel, FLOAT R, G, B.
#pragma once

#include "formats/interchange/export_format.h"

namespace spool::exchange {

// Into a folder. Errors: kData for a recording without a reference of other seeds (the
// largest input would become the target and contain the inputs), and for what is not finite.
interchange::ExportFormat oidn_target();

}  // namespace spool::exchange
