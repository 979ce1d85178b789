// Open Image Denoise as a filter: a network that other people trained [Oidn], in this process.
//
// It gets the means of the samples, albedo and normal where they were recorded (a normal only
// beside an albedo, as the library asks); radiance is linear and without a limit.
// It knows nothing of variances and counts. Not part of the library's own list: it is there when
// Open Image Denoise is (oidn_library.h).
#pragma once

#include "lib/filters/filter.h"
#include "lib/filters/oidn/oidn_library.h"

namespace spool {

enum class OidnFeatures { kNone, kAlbedo, kAll };

struct OidnOptions {
  OidnFeatures features = OidnFeatures::kAll;
  OidnSettings settings;
};

// It is made only where the library is there: else error kUsage, before any work.
Filter oidn_filter();

}  // namespace spool
