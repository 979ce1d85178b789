// Returns to an image what two halves of its samples agree that the filter took away. Like
// combiners of biased and unbiased images [GuIglesiasGuitianMoon22], it moves each pixel from the
// image towards the mean of its own samples; how far, independent halves decide.
//
// I_p = max(luminance of the image, 1e-3 U), U the scene's luminance. r_i = luminance of sample i /
// I_p. Means over pixels about as bright (below): F under a Gaussian of 1 pixel, W over 41 x 41.
//
//   a, b = means over the even and over the odd samples of min(r_i, 16)
//   u    = mean of both halves' r_i
//   A    = F a - W a,   B = F b - W b,   d = ((A - B) / 2)^2
//   bias = max(0, W(A B) - (W(A B) + W d) / sqrt N),   N: sum of the weights of W
//   t    = bias / (bias + max(W d, F d))
//   out  = image (1 + t minmod((A + B) / 2, F u - 1)),   minmod: the smaller of one sign, or 0
//
// Noise of the halves is independent, so W(A B) has the squared bias in expectation, whatever the
// noise; what a filter shares with both halves makes it smaller. What is subtracted is about a
// standard error of a mean over N pixels: few bright pixels in a window decide little. t is the
// share that least squares gives the samples. Without the limit of 16 single bright samples decide;
// without minmod a pixel free of noise in front of noisy ones, such as a lamp, would move, because
// the limit lowers only the others' means.
//
// Pixels about as bright: hat functions of log I, one apart; a mean is that under each hat,
// interpolated at p. Three apart, lamps decided about what is around them. Pixels without a sample
// in both halves, and those that are not finite, keep their value and take no part. Windows are cut
// at the border. Slow twin: tests/reference/returned_residual_reference.h.
#pragma once

#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/pool/sample_pool.h"
#include "lib/statistics/selection.h"

namespace spool {

// `image` [c][y][x] of pixels, radiance units, made of what `selection` took of `pool` (of halves
// that are used together, of pool_of_joined()). `unit`: U > 0, radiance units (scene_luminance.h).
RgbImage return_residual(RgbImage image, const Selection& selection, const SamplePool& pool,
                         double unit, GuardCounts& guards);

}  // namespace spool
