// What cannot judge: a reference without light, a variance that is none.
#pragma once

#include <string>

#include "lib/core/error.h"
#include "lib/core/image.h"
#include "lib/pool/recorded_samples.h"

namespace spool {

// kData, with the pixel, where the mean is finite and its variance is none. `name` opens the
// message.
Result<void> check_variance(const RgbImage& variance, const RgbImage& mean,
                            const std::string& name);

// The same of a recording's reference, and kData where no pixel of it is finite.
Result<void> check_reference(const Reference& reference, const std::string& recording);

}  // namespace spool
