// Whether a density of samples lies on edges or elsewhere: in noise, as of soft shadows.
#pragma once

#include "lib/core/image.h"

namespace spool {

// Share of the samples above the smallest count that lie within 2 pixels of an edge: of the tenth
// of the pixels, and one more, with the largest gradient of the logarithm of `luminance` [y][x],
// and all that are equal to the least of them. The floor of `luminance` is a thousandth of its
// mean. `counts`: of pieces, a whole number to a pixel. NaN where all counts are equal or there is
// no edge.
double edge_share(const Image<int>& counts, const Plane& luminance);

}  // namespace spool
