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

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/core/guards.h"
#include "lib/core/image.h"
#include "lib/metrics/metric_description.h"
#include "lib/metrics/metric_options.h"
#include "lib/metrics/reference_side.h"

namespace spool {

// What an estimate is judged by.
struct JudgingReference {
  RgbImage mean;                        // R
  std::optional<RgbImage> variance;     // b, variance of `mean`; absent: taken as exact
  std::optional<RgbImage> denominator;  // D of relMSE and of the deciles; absent: R
  std::shared_ptr<KeptSide> kept = {};  // of this R and D; absent: its side is made for each image
};

struct MetricValue {
  double value = std::numeric_limits<double>::quiet_NaN();           // NaN: not defined here
  double standard_error = std::numeric_limits<double>::quiet_NaN();  // NaN: not known
};

// What an error stands on. NaN: not known.
struct ErrorSupport {
  double worst_share = std::numeric_limits<double>::quiet_NaN();  // of the worst 0.1 % of pixels
  double half_pixels = std::numeric_limits<double>::quiet_NaN();  // how many bear half of it
  // Mean of the reference's variance, in units of the metric.
  double reference_noise = std::numeric_limits<double>::quiet_NaN();
};

struct MetricTable {
  std::vector<MetricValue> values;             // [metric], as metrics()
  std::vector<std::vector<double>> resampled;  // [metric][resample], for paired differences
  int blocks = 0;                              // that each resample draws
  double relative_scale = 1.0;                 // factor on both images in the relative metrics
  std::uint64_t pixels = 0;                    // judged
  std::uint64_t excluded_estimate = 0;         // pixels of I that are not finite
  std::uint64_t excluded_reference = 0;        // pixels without a finite R
  bool failed = false;                         // I held a non-finite pixel
  ErrorSupport squared, relative;              // of mse (before its debiasing) and of relmse
  GuardCounts guards;
  Plane flip;  // flip_ldr of each pixel, 0 where not judged; empty where it was not wanted

  const MetricValue& operator[](std::string_view name) const;  // the metric must exist
};

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
