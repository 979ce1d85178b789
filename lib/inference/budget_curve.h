// The error of one method over budgets: its slope, and how many samples it needs for a given error.
//
// Intervals are 95 % percentiles of the bootstrap of comparison.h: every resample draws replicates
// and pixel blocks, the same ones at all budgets and for all methods [EfronTibshirani93, 13].
#pragma once

#include <cstdint>
#include <vector>

#include "lib/inference/comparison.h"

namespace spool {

struct BudgetCurve {
  std::vector<double> spp;           // ascending
  std::vector<MethodSeries> series;  // [budget]
};

struct ErrorSlope {
  BudgetFit fit;  // of the means
  double low = 0, high = 0;
};
ErrorSlope error_slope(const BudgetCurve& curve, std::uint64_t seed = 1);

// Where the curve, straight between its points on logarithmic axes, first reaches the mean of
// `target`. Outside the measured budgets nothing is extrapolated: the end is given, with a mark.
struct SamplesNeeded {
  double spp = 0;  // NaN where nothing is known
  double low = 0, high = 0;
  bool at_most = false;    // reached at the smallest budget already
  bool more_than = false;  // not reached at the largest
};
SamplesNeeded samples_needed(const BudgetCurve& curve, const MethodSeries& target,
                             std::uint64_t seed = 1);

}  // namespace spool
