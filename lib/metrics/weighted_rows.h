// The inner loop of the convolutions of FLIP and SSIM.
#pragma once

#include <span>

namespace spool {

// to[x] = the sum of taps[i] * from[i][x], x below `width`, in the order of the taps.
void add_rows(std::span<const double> taps, std::span<const double* const> from, double* to,
              int width);

}  // namespace spool
