// How far an image is from what it should be: squared, relative and absolute errors, energy,
// tone-mapped peak signal-to-noise ratio, and the perceptual ones (perceptual_metrics.h), each with
// a bootstrap standard error.
//
// Inputs are images only [c][y][x]: linear RGB of equal size; a metric knows no method. With b the
// variance of the reference's mean, `mse` and the `relmse` family are debiased: (I - R)^2 - b has
// expectation (I - mu)^2 when R is independent of I, so they may come out slightly negative and are
// never clamped. An image that equals R is not independent of it: its errors are 0. Pixels that are
// not finite in I are left out and make the table `failed`; pixels not finite in R (nothing to
// judge by) are left out and counted.
// Precision: all sums double, per 16x16 block in row order, blocks combined pairwise; the bits do
// not depend on threads. Slow twin: tests/reference/error_metrics_reference.h.
#pragma once

#include <string>
#include <vector>

#include "lib/core/image.h"
#include "lib/metrics/judging_reference.h"
#include "lib/metrics/metric_description.h"
#include "lib/metrics/metric_options.h"
#include "lib/metrics/metric_table.h"

namespace spool {

// Alike to a part in a thousand in every pixel, as after a way through half floats: an error of
// such an image has no meaning. Sizes are equal.
bool is_the_reference(const RgbImage& image, const RgbImage& reference);

MetricTable error_metrics(const RgbImage& estimate, const JudgingReference& reference,
                          const MetricOptions& options = {});

// Per pixel [y][x], the part of one metric: its mean over the judged pixels is the metric. 0 where
// a pixel is not judged.
struct ErrorMap {
  std::string metric;
  Plane parts;
};
// Of those that options.wanted holds of mse, relmse, relmse_trimmed, smape, energy_ratio, and of
// flip_ldr unless options.perceptual is kNone.
std::vector<ErrorMap> error_maps(const RgbImage& estimate, const JudgingReference& reference,
                                 const MetricOptions& options = {});

// (I - R)^2 - b averaged over channels, per pixel: the error map of pictures. NaN where excluded.
Plane squared_error_map(const RgbImage& estimate, const JudgingReference& reference);

}  // namespace spool
