// Means and variances of the clamped samples, and of the logarithms of the samples: what the two
// guides are made of.
//
// The difference of the halves is (mean of the even samples - mean of the odd ones)
// sqrt(n_even n_odd) / n: nothing in expectation, and of the variance of the mean. It is 0 where
// there is one sample.
// Groups: agreed_light.h.
//
// All in units (RadianceScale), so float holds it. Variances are those of the mean
// (variance_of_mean.h, mode auto), blurred with a Gaussian of one piece. Where few samples carry
// the light (NoisePool::share) they are at least those of a pool of pieces (grown_variance.h), and
// 1 + 8 / max(n, 8) times as large: of a few samples the largest are missing. A piece without
// samples takes its neighbours' values. Slow twin:
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

// Where variances come from a pool of pieces, and of how many.
struct NoisePool {
  int radius = 0;      // the largest of the pool, pieces
  const Plane& share;  // [y][x] of pieces, 0 .. 1: how far the pool counts; empty: nowhere
  bool unused() const { return radius == 0 || share.empty(); }
};

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
                             const NoisePool& noise_pool, const RadianceScale& scale,
                             GuardCounts& guards);

}  // namespace spool
