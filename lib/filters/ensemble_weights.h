// Weights for a convex mean of images, from independent halves of the samples they were made of.
//
// A_k, B_k: images of the even and of the odd samples by part k; yA, yB: means of the same samples;
// mA, mB: means over k of A_k, B_k; m0 = max(0, (mA + mB) / 2); L: luminance of the scene.
//
//   top  = 20 (G_1 luminance(m0) + 0.1 L),   tA = yA min(1, top / luminance(yA))
//   TA   = tA + (m0 + 0.1 L) min(l(yA) - l(tA), max(0, l(m0) - l(tA))) / (l(m0) + 0.1 L)
//          TB likewise;   l(.) = G_16 luminance(.)
//   r_k  = G_16 sum omega (a_k (TB - mA) + b_k (TA - mB) + (a_k - b_k)(mA - mB) / 2)
//   M_jk = G_16 sum omega (a_j a_k + b_j b_k - (a_j - b_j)(a_k - b_k) / 2)
//   w    = argmin w'(M + t I) w - 2 (r + t / K)'w over w >= 0, sum 1
//
// with a_k = A_k - mA, b_k = B_k - mB, omega = 1 / (m0^2 + (0.1 L)^2), sums over channels, and
// t = a quarter of the mean diagonal of M. Each image of one half is judged by the mean of the
// other half, which shares no noise with it; the last terms bring the noise of a half to that of
// the mean of two. Cross-fitting is that of stacked regressions [Breiman96]. G_s: Gaussian of s
// pixels, cut at 4 s and at the border. Slow twin: tests/reference/ensemble_reference.h.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lib/core/image.h"

namespace spool {

inline constexpr std::size_t kMostEnsembleParts = 4;  // all subsets of the parts are tried

// Images of the even and of the odd samples by one part, radiance units.
using HalfImages = std::array<RgbImage, 2>;

// At least one, all of one size.
RgbImage mean_of(std::span<const RgbImage* const> images);

// [part][y][x], >= 0, sum 1. `means`: yA and yB, unfiltered and not clamped. `luminance`: L > 0.
std::vector<Plane> cross_fitted_weights(std::span<const HalfImages> parts, const HalfImages& means,
                                        double luminance);

}  // namespace spool
