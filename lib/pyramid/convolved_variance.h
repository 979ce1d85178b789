// Variance of a convolution of independent pixels.
//
// convolve() with squared taps is that within the image; at its border several taps fall on one
// pixel, and their sum has to be squared.
// Slow twin: tests/reference/gaussian_reference.h.
#pragma once

#include "lib/core/extend.h"
#include "lib/core/image.h"
#include "lib/pyramid/wavelet_filters.h"

namespace spool {

// From the variances of the pixels to those of convolve(pixels, taps, 1, extension).
void convolve_variance(Plane& variance, const Taps& taps,
                       Extension extension = Extension::kSymmetric);

}  // namespace spool
