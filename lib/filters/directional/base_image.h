// The base image, which size 1 means: each piece's mean mixed with its eight neighbours.
#pragma once

#include "lib/filters/directional/options.h"

namespace spool {

// The base image's taps, or a single 1 without one.
Taps base_taps(BaseImage base);
// Those of its variance.
Taps squared_base_taps(BaseImage base);

}  // namespace spool
