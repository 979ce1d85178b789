// The discrete Fourier transform of any length, for cross-checks.
//
// forward: X(k) = sum_n x(n) exp(-2 pi i k n / N); inverse: with + and divided by N. Powers of two
// by radix-2 steps, other lengths as a convolution [Bluestein70]: O(N log N) for every N.
#pragma once

#include <complex>
#include <vector>

namespace spool {

enum class FourierDirection { kForward, kInverse };

void fourier_transform(std::vector<std::complex<double>>& values, FourierDirection direction);

// Row-major values of a width x height image, rows then columns.
void fourier_transform_2d(std::vector<std::complex<double>>& values, int width, int height,
                          FourierDirection direction);

}  // namespace spool
