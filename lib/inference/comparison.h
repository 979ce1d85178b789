// Which of several methods is better, and whether that can be said: paired differences over pixels
// and replicates, ranks with ties, and how fast errors fall with the budget.
//
// Methods are compared on the same recording, budget and replicates, so what they share cancels.
// The standard error of a difference comes from a bootstrap over replicates and 16x16 pixel blocks
// at once (method_series.h), with the same draws for every method.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lib/inference/method_series.h"
#include "lib/metrics/error_metrics.h"

namespace spool {

struct PairedComparison {
  double difference = 0;      // mean of a - b
  double standard_error = 0;  // NaN when it is not known
  double low = 0, high = 0;   // 95 %, by Student's distribution
  double p = 1;               // two-sided, of no difference
};
// Both series must have the same replicates. Pairs with a value that is not finite are left out.
PairedComparison compare_paired(const MethodSeries& a, const MethodSeries& b,
                                std::uint64_t seed = 1);

// Family-wise p-values by Holm's step-down rule [Holm79], in the order given.
std::vector<double> holm_adjusted(std::span<const double> p);

struct RankedMethod {
  std::size_t method = 0;  // index into the series
  double mean = 0;
  int rank = 1;               // 1 + the number of methods that are significantly better
  double p_against_best = 1;  // Holm-adjusted
};
// Best mean first. Methods that no other beats significantly share rank 1, and so on: equal ranks
// are ties. `better` says which way is better; kOne ranks by the distance from 1.
std::vector<RankedMethod> rank_methods(std::span<const MethodSeries> methods, Better better,
                                       double significance = 0.05, std::uint64_t seed = 1);

// The same from the comparisons with the best mean alone: rank 1 for all that are not told apart
// from it, 2 for the rest. For many methods, where all pairs are too many.
std::vector<RankedMethod> rank_against_best(std::span<const MethodSeries> methods, Better better,
                                            double significance = 0.05, std::uint64_t seed = 1);

// log error = intercept + slope log budget by least squares; unfiltered estimates have slope -1
// until adaptive bias or the noise of the reference shows. Points that are not positive are left
// out; NaN with fewer than two left, and no standard error with fewer than three.
struct BudgetFit {
  int points = 0;
  double slope = 0, intercept = 0, slope_standard_error = 0;
};
BudgetFit fit_error_over_budget(std::span<const double> budget, std::span<const double> error);

}  // namespace spool
