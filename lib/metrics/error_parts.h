// The squared error of a method in two parts: what it always does wrong (bias), and how its image
// changes from samples to samples (variance).
//
// A and B are images that one method made of two disjoint sets of samples, R the reference with
// variance b, all three independent. Per pixel and channel
//
//   bias^2   = (A - R)(B - R) - b     expectation (E A - mu)^2
//   variance = (A - B)^2 / 2          expectation var A
//
// and their sum is the mean of the two images' squared errors, exactly. Nothing is assumed of the
// samples' distribution, and nothing is shared by A and B that would have to be corrected for. Bias
// squared may come out negative where it is small. Relative parts divide by D^2 + rel_eps after the
// relative scale, as relmse does. Sums run pairwise over the pixels; the bits do not depend on
// threads. Slow twin: tests/reference/error_metrics_reference.h.
#pragma once

#include <cstdint>

#include "lib/metrics/error_metrics.h"

namespace spool {

struct ErrorParts {
  double bias2 = 0.0, variance = 0.0;                    // means over pixels and channels
  double relative_bias2 = 0.0, relative_variance = 0.0;  // of relmse
  std::uint64_t pixels = 0;  // finite in both images and the reference; 0: all parts are NaN
};

// `relative_scale`: MetricTable::relative_scale of the reference.
ErrorParts error_parts(const RgbImage& a, const RgbImage& b, const JudgingReference& reference,
                       double relative_scale, const MetricOptions& options = {});

}  // namespace spool
