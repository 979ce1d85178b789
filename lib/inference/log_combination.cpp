#include "lib/inference/log_combination.h"

#include <algorithm>
#include <cmath>

#include "lib/core/check.h"
#include "lib/core/student.h"

namespace spool {

Series log_combination(std::span<const WeightedSeries> parts) {
  SPOOL_CHECK(!parts.empty());
  const Series& first = *parts.front().series;
  Series sum{std::vector<double>(first.values.size(), 0.0)};
  sum.recordings = first.recordings;
  sum.halves = difference_of(first.halves, parts.front().weight, first.halves, 0.0);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const auto& [weight, series] = parts[p];
    SPOOL_CHECK_EQ(series->values.size(), sum.values.size());
    const bool positive = all_positive(series->values);
    for (std::size_t r = 0; r < sum.values.size(); ++r) {
      const double value = series->values[r];
      const bool usable = positive && std::isfinite(value);
      sum.values[r] += usable ? weight * std::log(value) : std::nan("");
    }
    sum.correlation = std::max(sum.correlation, series->correlation);
    if (series->withheld != Withheld::kNo) sum.withheld = series->withheld;
    if (p > 0) sum.halves = difference_of(sum.halves, 1.0, series->halves, -weight);
  }
  return sum;
}

Interval interval_of_logs(const Series& logs) {
  const MeanError found =
      mean_error(logs.values, logs.correlation, half_variance(logs.halves), logs.recordings);
  Interval interval;
  interval.n = found.n;
  interval.mean = found.mean;
  if (found.n < 2 || logs.withheld != Withheld::kNo) return interval;
  interval.standard_error = found.standard_error;
  interval.freedom = found.freedom;
  const double reach = student_quantile(0.975, found.freedom) * found.standard_error;
  interval.low = interval.mean - reach;
  interval.high = interval.mean + reach;
  return interval;
}

Interval ratio_of_logs(const Series& logs) {
  Interval ratio = interval_of_logs(logs);
  for (double* end : {&ratio.mean, &ratio.low, &ratio.high})
    *end = std::exp(*end);
  ratio.logarithmic = true;
  return ratio;
}

}  // namespace spool
