// Values of the metrics that are rules on sums over pixels (metric_list.h), of the whole image or
// of a resample of its blocks.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "lib/metrics/bootstrap.h"
#include "lib/metrics/largest_first.h"
#include "lib/metrics/metric_list.h"
#include "lib/metrics/metric_table.h"
#include "lib/metrics/pixel_errors.h"

namespace spool {

inline constexpr int kWhole = -1;  // the image instead of a resample

// Some pixel is judged. What several metrics or resamples need is made when the first asks for it.
class MetricValues {
 public:
  // Both are looked at as long as this lives.
  MetricValues(const PixelErrors& errors, const BlockBootstrap& bootstrap);

  // NaN for a perceptual metric.
  double value(const Metric& metric, int resample);
  double sum(int term, int resample);  // over the pixels
  // Whether resamples of it differ: their spread is a standard error.
  bool has_standard_error(const Metric& metric) const;
  // What mse before its debiasing, and relmse, stand on.
  ErrorSupport squared_support();
  ErrorSupport relative_support();

  const Plane& relative() const { return relative_; }  // relmse of each pixel, debiased

 private:
  void add_up_blocks();
  double ratio(const Metric& metric, int resample);
  double trimmed(Rule rule, int resample);
  double of_rank(Rule rule, int resample);
  double equal_energy(const Metric& metric, int resample);
  double scaled_error(int squares, int first, int last, int resample);
  double copies_of(std::size_t pixel, int resample) const;
  double sum_behind(double drop, int resample);
  LargestFirst& largest_squared();
  LargestFirst& largest_relative();
  ErrorSupport support(const Plane& values, LargestFirst& largest, int squares);

  const PixelErrors& errors_;
  const BlockBootstrap& bootstrap_;
  std::array<std::vector<double>, kTermCount> sums_;       // [term][block]
  std::array<std::vector<double>, kTermCount> resampled_;  // [term][resample]
  Plane relative_, squared_;  // per pixel: relMSE debiased, squared error raw
  std::optional<LargestFirst> largest_relative_, largest_squared_;
};

// How many of `count` pixels a trimmed mean leaves out, the largest first.
double trimmed_pixels(double count, const MetricOptions& options);

}  // namespace spool
