// Estimated variance of each piece's mean, v.
//
//   raw     v = M2 / ((n - 1) n), defined for n >= 2
//   pooled  s2 = (M2 + nu0 s2bar) / (max(n - 1, 0) + nu0), v = s2 / n, with s2bar = sum of M2 / sum
//   of
//           max(n - 1, 0) over a 5x5 window that grows (9, 17, ...) until its denominator is
//           positive
//   auto    pooled where n < 4, raw elsewhere
// A Bernoulli pixel with two samples often has M2 = 0 exactly, which stops every selector that
// weighs bias against variance; pooling is the cure. Where no piece of the image has two samples,
// s2bar is half the mean squared difference of the means of horizontal and vertical neighbours.
#pragma once

#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/statistics/piece_statistics.h"

namespace spool {

enum class VarianceMode { kAuto, kRaw, kPooled };

// Weight of the neighbourhood in a pooled variance, in samples.
inline constexpr double kNu0 = 2.0;

struct VarianceOptions {
  VarianceMode mode = VarianceMode::kAuto;
  // Mean luminance of the image in the units of the mean, 1 where it is exposed. Floor:
  // v >= (1e-6 (|mean| + 1e-3 scale))^2; counted.
  double scale = 1.0;
};

// The least variance that variance_of_mean gives: a piece that has exactly this is flat as far as
// anyone can see.
double variance_floor(double mean, double scale = 1.0);

// Pieces with n = 0 get v = +infinity (nothing is known of them).
Plane variance_of_mean(const CountImage& n, const Plane& mean, const Plane& m2,
                       const VarianceOptions& options, GuardCounts& guards);

// Of the analysis signal.
Plane analysis_variance(const PieceStatistics& statistics, const VarianceOptions& options,
                        GuardCounts& guards);

}  // namespace spool
