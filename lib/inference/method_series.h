// One metric of one method over replicates, and how far its mean may lie from what it estimates.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lib/metrics/error_metrics.h"

namespace spool {

struct MethodSeries {
  std::string name;
  std::vector<double> values;                  // [replicate]
  std::vector<std::vector<double>> resampled;  // [replicate][resample], for all the same blocks
  int blocks = 0;                              // of an image; 0: not known, taken as many
};

// The values of `metric` in the tables of one method's replicates.
MethodSeries method_series(std::string name, std::string_view metric,
                           std::span<const MetricTable* const> replicates);

// a - b, replicate by replicate and resample by resample; NaN where either is not known. Both must
// have the same replicates.
MethodSeries difference_of(const MethodSeries& a, const MethodSeries& b);

// Resamples of the mean over replicates, a bootstrap over pixel blocks and over replicates at once.
//
// Noise that is particular to one block of one replicate would be drawn twice, once with the blocks
// and once with the replicates. So resample s takes the s-th draw of blocks in every replicate, and
// the draw of replicates adds only what these vary beyond that noise (as two-way clustered
// variances do [CameronGelbachMiller11]).
struct ResampledMean {
  double mean = std::numeric_limits<double>::quiet_NaN();  // of the finite values
  std::vector<double> means;                               // [resample]
  double standard_error = std::numeric_limits<double>::quiet_NaN();
  double freedom = std::numeric_limits<double>::infinity();  // of standard_error [Satterthwaite46]

  // Standard errors to either side of the mean for 95 %.
  double reach() const;
};
// Draws of replicates depend on `seed`, resample and number of replicates only.
ResampledMean resampled_mean(const MethodSeries& series, std::uint64_t seed = 1);

// The resamples, spread about the mean so that their normal percentiles are those of Student's
// distribution: percentile intervals of what is computed from them then allow for few blocks.
std::vector<double> stretched_means(const ResampledMean& resampled);

}  // namespace spool
