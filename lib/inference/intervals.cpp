#include "lib/inference/intervals.h"

#include <algorithm>
#include <cmath>

#include "lib/core/check.h"
#include "lib/core/student.h"

namespace spool {
namespace {

constexpr double kNormal95 = 1.959963984540054;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<double> logarithms(std::span<const double> values) {
  std::vector<double> logs;
  for (const double value : values)
    logs.push_back(std::log(value));
  return logs;
}

// The mean as it was averaged, of logarithms or not, becomes the mean that is printed.
void finish(Interval& interval, double reach, Range range) {
  interval.low = interval.mean - reach;
  interval.high = interval.mean + reach;
  if (interval.logarithmic) {
    for (double* end : {&interval.mean, &interval.low, &interval.high})
      *end = std::exp(*end);
  }
  const double least = range == Range::kReal ? -kInfinity : 0.0;
  if (interval.mean < least) return;
  const double most = range == Range::kShare ? 1.0 : kInfinity;
  if (interval.low < least) interval.low = least;
  if (interval.high > most) interval.high = most;
}

}  // namespace

bool Series::alike() const {
  const auto first = std::ranges::find_if(values, [](double v) { return std::isfinite(v); });
  return known() > 1 &&
         std::ranges::all_of(values, [&](double v) { return v == *first || std::isnan(v); });
}

int Series::known() const {
  return static_cast<int>(std::ranges::count_if(values, [](double v) { return std::isfinite(v); }));
}

bool Series::unbounded() const {
  return std::ranges::any_of(values, [](double value) { return std::isinf(value); });
}

bool all_positive(std::span<const double> values) {
  bool any = false;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    if (!(value > 0.0) || std::isinf(value)) return false;
    any = true;
  }
  return any;
}

namespace {

// [recording that has any] the mean of its finite values.
std::vector<double> recording_means(std::span<const double> values, int recordings) {
  const std::size_t each = values.size() / static_cast<std::size_t>(recordings);
  std::vector<double> means;
  for (std::size_t first = 0; first + each <= values.size() && each > 0; first += each) {
    const MeanError one = mean_error(values.subspan(first, each), 0.0);
    if (!std::isnan(one.mean)) means.push_back(one.mean);
  }
  return means;
}

}  // namespace

MeanError mean_error(std::span<const double> values, double correlation, const HalfSpread& between,
                     int recordings) {
  SPOOL_CHECK_GE(correlation, 0.0);
  if (recordings >= kOwnSpread) {
    const std::vector<double> means = recording_means(values, recordings);
    if (means.size() >= static_cast<std::size_t>(kOwnSpread)) {
      MeanError found = mean_error(means, 0.0);
      found.n = static_cast<int>(
          std::ranges::count_if(values, [](double value) { return std::isfinite(value); }));
      return found;
    }
  }
  MeanError found;
  double mean = 0.0, m2 = 0.0, infinite = 0.0;
  for (const double value : values) {
    if (std::isinf(value)) infinite += value;
    if (!std::isfinite(value)) continue;
    ++found.n;
    const double delta = value - mean;
    mean += delta / found.n;
    m2 += delta * (value - mean);
  }
  if (infinite != 0.0) {  // both infinities: not a number
    found.mean = infinite;
    return found;
  }
  if (found.n == 0) return found;
  found.mean = mean;
  if (found.n < 2) return found;
  const double n = found.n;
  found.freedom = n - 1.0;
  if (between.freedom > 0.0) {
    const double common = std::min(correlation, 1.0);
    found.freedom = between.freedom + (n - 1.0) * (1.0 - common);
    double of_one = (between.freedom * between.variance + m2) / found.freedom;
    const double of_replicates = common < 1.0 ? m2 / (n - 1.0) / (1.0 - common) : 0.0;
    if (of_replicates > of_one) {
      of_one = of_replicates;
      found.freedom = std::min(found.freedom, n - 1.0);
    }
    found.standard_error = std::sqrt(of_one * (1.0 + (n - 1.0) * common) / n);
  } else if (m2 == 0.0) {
    found.standard_error = 0.0;
  } else if (correlation >= 1.0) {
    found.standard_error = kInfinity;
  } else {
    found.standard_error =
        std::sqrt(m2 / (n - 1.0) / n * (1.0 + (n - 1.0) * correlation) / (1.0 - correlation));
  }
  return found;
}

Interval mean_interval(const Series& series, Range range) {
  Interval interval;
  interval.logarithmic = range == Range::kPositive && all_positive(series.values);
  HalfSpread between = half_variance(series.halves);
  if (!interval.logarithmic) {
    const double mean = mean_error(series.values, 0.0).mean;
    between.variance *= mean * mean;
  }
  const MeanError found =
      mean_error(interval.logarithmic ? logarithms(series.values) : series.values,
                 series.correlation, between, series.recordings);
  interval.n = found.n;
  interval.mean = found.mean;
  double reach = kNaN;
  if (found.n >= 2 && !series.unbounded() && series.withheld == Withheld::kNo) {
    interval.standard_error = found.standard_error;
    interval.freedom = found.freedom;
    reach = student_quantile(0.975, interval.freedom) * found.standard_error;
  }
  finish(interval, reach, range);
  return interval;
}

Interval single_interval(double value, double standard_error, int blocks, Range range) {
  if (blocks >= 2) standard_error *= std::sqrt(blocks / (blocks - 1.0));  // a resample's lacks it
  Interval interval;
  interval.n = std::isfinite(value) ? 1 : 0;
  interval.logarithmic = range == Range::kPositive && value > 0.0;
  interval.mean = interval.logarithmic ? std::log(value) : value;
  interval.standard_error = interval.logarithmic ? standard_error / value : standard_error;
  interval.freedom = std::max(1.0, blocks - 1.0);
  finish(interval, student_quantile(0.975, interval.freedom) * interval.standard_error, range);
  interval.mean = value;
  return interval;
}

Interval mean_of_intervals(std::span<const Interval> intervals) {
  Interval result;
  if (intervals.empty()) return result;
  const auto k = static_cast<double>(intervals.size());
  result.logarithmic = intervals.front().logarithmic;
  double sum = 0.0, variance = 0.0, spread = 0.0;
  for (const Interval& one : intervals) {
    if (one.logarithmic != result.logarithmic || !std::isfinite(one.mean)) return Interval{};
    sum += result.logarithmic ? std::log(one.mean) : one.mean;
    const double part = one.standard_error * one.standard_error / (k * k);
    variance += part;
    if (std::isfinite(one.freedom)) spread += part * part / one.freedom;
  }
  result.n = static_cast<int>(intervals.size());
  result.mean = sum / k;
  double reach = kNaN;
  if (std::isfinite(variance)) {
    result.standard_error = std::sqrt(variance);
    result.freedom = spread > 0.0 ? std::max(1.0, variance * variance / spread) : kInfinity;
    reach = result.standard_error *
            (std::isfinite(result.freedom) ? student_quantile(0.975, result.freedom) : kNormal95);
  }
  finish(result, reach, Range::kReal);
  return result;
}

}  // namespace spool
