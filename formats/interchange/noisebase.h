// A sample set of Noisebase [Noisebase] (SampleSet v1, a Zarr v2 store in a zip): import.
//
// Radiance is stored there as 8-bit RGBE with a random rounding: it is decoded, and what the
// rounding added stays in it. position, motion, normal, albedo (called diffuse there) and the
// reference come over unchanged; camera arrays go to `meta`. A training file holds a sequence: one
// frame is taken.
#pragma once

#include "formats/interchange/import_format.h"

namespace spool::interchange {

// Errors: kDamage for chunks that are missing or damaged, kData for arrays that are not a
// SampleSet, kUsage for a sequence without the option `frame`.
ImportFormat noisebase_format();

}  // namespace spool::interchange
