// Means and variances of the clamped samples, and of the logarithms of the samples: what the two
// guides are made of.
//
// The difference of the halves is (mean of the even samples - mean of the odd ones)
// sqrt(n_even n_odd) / n: nothing in expectation, and of the variance of the mean. It is 0 where
// there is one sample.
// Groups: agreed_light.h.
//
// All in units (RadianceScale), so float holds it. Variances are those of the mean
// (variance_of_mean.h, mode auto), blurred with a Gaussian of one piece, and at least what a pool
// of up to `noise_pool` pieces around says (grown_variance.h): few samples may carry the light. A
// piece without samples takes its neighbours' values. Slow twin:
// tests/reference/twin_guides_reference.h.
#pragma once

#include <array>
#include <vector>

#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/filters/twin_guides/options.h"
#include "lib/pool/sample_pool.h"

namespace spool {

using FloatRgb = std::array<Image<float>, 3>;

struct SampleMoments {
  FloatRgb mean, variance;                  // of the clamped samples
  FloatRgb difference;                      // of their halves
  FloatRgb log_mean, log_variance;          // of log(max(x, 0) + kLogFloor L), x not clamped
  Image<float> log_luminance;               // mean of the same of the luminance
  std::vector<Image<float>> clamped_light;  // [group] mean luminance that the clamp took
};

// `limit`: luminance [y][x] of pixels, in radiance, that a sample is scaled down to
// (lib/kernels/sample_clamp.h).
SampleMoments sample_moments(const SamplePool& pool, const CountImage& n, const Plane& limit,
                             int noise_pool, const RadianceScale& scale, GuardCounts& guards);

}  // namespace spool
