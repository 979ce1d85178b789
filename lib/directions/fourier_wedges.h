// Directional bands by smooth wedges in the frequency plane: a cross-check of the filter bank.
//
// Wedge weights have cos^2 ramps of half-width 8 degrees at the borders of band_borders() and sum
// to 1; the zero frequency is shared equally. The image is first extended to one period of its
// extension (symmetric: twice its size). Cost: 1 + 2^l / 2 complex transforms of that period, about
// 7 us a pixel at l = 3; double inside. Dilation has no meaning here: a wedge has no scale.
#pragma once

#include <vector>

#include "lib/core/extend.h"
#include "lib/core/image.h"

namespace spool {

// levels 1 .. 3; bands has 2^levels images of the size of `image`; not for kClamp, which has no
// period.
template <class T>
void fourier_wedge_bands(const Image<T>& image, int levels, Extension extension,
                         std::vector<Image<T>>& bands);

// Weight of band i at a frequency angle in degrees.
double wedge_weight(int levels, int band, double angle);

}  // namespace spool
