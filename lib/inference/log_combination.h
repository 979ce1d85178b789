// Weighted sums of logarithms of errors that were measured on the same replicates: ratios, slopes,
// and errors between two budgets.
#pragma once

#include <span>

#include "lib/inference/intervals.h"

namespace spool {

struct WeightedSeries {
  double weight = 1.0;
  const Series* series = nullptr;
};

// Replicate by replicate; NaN where one has no value, and everywhere as soon as one value is not
// positive: those that are left would be the large ones of a debiased error. What is known of the
// spread between recordings goes along, and what one of them withholds is withheld.
Series log_combination(std::span<const WeightedSeries> parts);

// Of the mean of what log_combination() returned, as it is.
Interval interval_of_logs(const Series& logs);
// The same as a ratio: the exponential of mean and ends.
Interval ratio_of_logs(const Series& logs);

}  // namespace spool
