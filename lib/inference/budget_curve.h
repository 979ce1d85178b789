// The error of one method over budgets: its slope, and how many samples it needs for a given error.
//
// Both work on logarithms, and on replicates: replicate r of all budgets and methods belongs
// together. Intervals are 95 %, Student's over the replicates (intervals.h).
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "lib/inference/intervals.h"

namespace spool {

struct BudgetCurve {
  std::vector<double> spp;     // ascending
  std::vector<Series> series;  // [budget]; the same replicates
};

// Mean over replicates of the slope of log error over log budget by least squares; unfiltered
// estimates have slope -1 until adaptive bias or the noise of the reference shows. A replicate with
// fewer than two values has no slope; where one value is not positive none is known.
Interval error_slope(const BudgetCurve& curve);

// Slope of log(error) over log(budget) by least squares; NaN with fewer than two positive points.
double log_slope(std::span<const double> budget, std::span<const double> error);

// Where the curve, straight between its points on logarithmic axes, first reaches the mean of
// `target`; `low` to `high` are the budgets at which the two are not separated. Outside the
// measured budgets nothing is extrapolated: the end is given, with a mark where `low` and `high`,
// if known, lie there too. Nothing is known where one value is not positive.
struct SamplesNeeded {
  double spp = std::numeric_limits<double>::quiet_NaN();  // where nothing is known
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
  bool at_most = false;    // reached at the smallest budget already
  bool more_than = false;  // not reached at the largest
};
SamplesNeeded samples_needed(const BudgetCurve& curve, const Series& target);

}  // namespace spool
