// Sums over square windows at a price that does not depend on the window's size.
#pragma once

#include "lib/core/image.h"

namespace spool {

// out(x, y) = sum of in(px, py), |px - x| <= radius, |py - y| <= radius, cut at the borders.
//
// Lines are cut into blocks of one window's length; a window is the end of a block and the
// beginning of the next, whose running sums are kept [VanHerk92]. Nothing is subtracted, so a
// firefly is felt in its own windows only.
Plane window_sums(Plane in, int radius);

}  // namespace spool
