#include "lib/inference/comparison.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/core/check.h"
#include "lib/core/student.h"

namespace spool {
namespace {

// Of values that both have; 0 where either does not vary.
double sample_correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double mean_a = 0.0, mean_b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
  int n = 0;
  for (std::size_t r = 0; r < a.size(); ++r) {
    if (!std::isfinite(a[r]) || !std::isfinite(b[r])) continue;
    ++n;
    const double from_a = a[r] - mean_a, from_b = b[r] - mean_b;
    mean_a += from_a / n;
    mean_b += from_b / n;
    aa += from_a * (a[r] - mean_a);
    bb += from_b * (b[r] - mean_b);
    ab += from_a * (b[r] - mean_b);
  }
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0;
}

double difference_correlation(const Series& a, const Series& b, const std::vector<double>& costs_a,
                              const std::vector<double>& costs_b) {
  return shared_by_differences(std::max(a.correlation, b.correlation),
                               shared_by_methods(a.taken, b.taken),
                               sample_correlation(costs_a, costs_b));
}

// The same where halves say how much of the difference varies with either method: one that takes
// nearly all samples of a few pieces does not make what the other one adds alike.
double measured_correlation(const Series& a, double slope_a, const Series& b, double slope_b) {
  const double of_a = slope_a * slope_a * half_variance(a.halves).variance;
  const double of_b = slope_b * slope_b * half_variance(b.halves).variance;
  if (!(of_a + of_b > 0.0)) return std::max(a.correlation, b.correlation);
  return (of_a * a.correlation + of_b * b.correlation) / (of_a + of_b);
}

// By how much a cost changes where the metric changes by a share of itself.
double cost_slope(const Series& series, Better better, bool logarithmic) {
  if (logarithmic) return 1.0;
  double mean = 0.0;
  for (const double value : series.values) {
    if (std::isfinite(value)) mean += value / series.known();
  }
  if (better == Better::kHigher) return -mean;
  if (better == Better::kOne) return mean >= 1.0 ? 1.0 : -1.0;
  return mean;
}

// Of those that both have, where each has its own place.
bool same_values(const Series& a, const Series& b) {
  if (a.values.size() != b.values.size()) return false;
  for (std::size_t r = 0; r < a.values.size(); ++r) {
    const bool both = !std::isnan(a.values[r]) && !std::isnan(b.values[r]);
    if (both && a.values[r] != b.values[r]) return false;
  }
  return true;
}

// Sets what is known of the pair without a test; whether a test can say more.
bool can_tell(Comparison& c, const Series& a, const Series& b) {
  c.identical = c.n > 0 && same_values(a, b);
  c.withheld = a.withheld != Withheld::kNo ? a.withheld : b.withheld;
  return c.n >= 2 && !a.alike() && !b.alike() && !a.unbounded() && !b.unbounded() &&
         c.withheld == Withheld::kNo;
}

void test(Comparison& c, double standard_error, double freedom) {
  c.standard_error = standard_error;
  c.freedom = freedom;
  const double reach = student_quantile(0.975, freedom) * standard_error;
  c.low = c.difference - reach;
  c.high = c.difference + reach;
  c.p = c.p_of(0.0);
}

// Mean cost of a series with the spread that its halves give it.
MeanError mean_cost(const Series& series, Better better, bool logarithmic) {
  HalfSpread between = half_variance(series.halves);
  const double slope = cost_slope(series, better, logarithmic);
  between.variance *= slope * slope;
  return mean_error(costs(series, better, logarithmic), series.correlation, between,
                    series.recordings);
}

}  // namespace

bool compares_logarithms(const Series& a, const Series& b, Better better) {
  return better == Better::kLower && all_positive(a.values) && all_positive(b.values);
}

double cost(double value, Better better, bool logarithmic) {
  if (better == Better::kHigher) return -value;
  if (better == Better::kOne) return std::abs(value > 0.0 ? std::log(value) : value - 1.0);
  return logarithmic ? std::log(value) : value;
}

std::vector<double> costs(const Series& series, Better better, bool logarithmic) {
  std::vector<double> result;
  for (const double value : series.values)
    result.push_back(std::isfinite(value) ? cost(value, better, logarithmic) : value);
  return result;
}

double Comparison::p_of(double limit) const {
  const double distance = difference - limit;
  if (distance == 0.0 || std::isinf(standard_error)) return 1.0;
  return standard_error > 0.0 ? student_two_sided(distance / standard_error, freedom) : 0.0;
}

Interval Comparison::ratio() const {
  Interval found;
  if (!logarithmic) return found;
  found.n = n;
  found.mean = std::exp(difference);
  found.low = std::exp(low);
  found.high = std::exp(high);
  found.logarithmic = true;
  found.standard_error = standard_error;
  found.freedom = freedom;
  return found;
}

Comparison compare_paired(const Series& a, const Series& b, Better better) {
  return compare_paired(a, b, better, compares_logarithms(a, b, better));
}

Comparison compare_paired(const Series& a, const Series& b, Better better, bool logarithmic) {
  SPOOL_CHECK_EQ(a.values.size(), b.values.size());
  Comparison c;
  c.logarithmic = logarithmic;
  const std::vector<double> first = costs(a, better, c.logarithmic);
  const std::vector<double> second = costs(b, better, c.logarithmic);
  std::vector<double> differences;
  for (std::size_t r = 0; r < first.size(); ++r)
    differences.push_back(first[r] - second[r]);
  const double slope_a = cost_slope(a, better, c.logarithmic);
  const double slope_b = cost_slope(b, better, c.logarithmic);
  const std::vector<HalfDifference> halves = difference_of(a.halves, slope_a, b.halves, slope_b);
  const double correlation = halves.empty() ? difference_correlation(a, b, first, second)
                                            : measured_correlation(a, slope_a, b, slope_b);
  const MeanError found = mean_error(differences, correlation, half_variance(halves), a.recordings);
  c.n = found.n;
  c.difference = found.mean;
  c.correlation = correlation;
  if (!can_tell(c, a, b)) return c;
  test(c, found.standard_error, found.freedom);
  return c;
}

Comparison compare_independent(const Series& a, const Series& b, Better better) {
  Comparison c;
  c.logarithmic = compares_logarithms(a, b, better);
  const MeanError first = mean_cost(a, better, c.logarithmic);
  const MeanError second = mean_cost(b, better, c.logarithmic);
  c.n = std::min(first.n, second.n);
  c.difference = first.mean - second.mean;
  if (!can_tell(c, a, b)) return c;
  const double va = first.standard_error * first.standard_error;
  const double vb = second.standard_error * second.standard_error;
  const double sum = va + vb;
  const double spread = va * va / first.freedom + vb * vb / second.freedom;
  // The larger of the two freedoms at most; of values without spread either would do.
  const double freedom =
      std::isfinite(sum) && spread > 0.0 ? std::max(1.0, sum * sum / spread) : c.n - 1.0;
  test(c, std::sqrt(sum), freedom);
  return c;
}

namespace {

// The least number above `now` that is enough, to three digits; infinite where none below 10^9 is.
template <class IsEnough>
double least_from(double now, const IsEnough& is_enough) {
  double most = now + 1.0;
  while (!is_enough(most)) {
    most *= 2.0;
    if (most > 1e9) return std::numeric_limits<double>::infinity();
  }
  double too_few = std::max(now, most / 2.0);
  while (most - too_few > std::max(1.0, 1e-3 * most)) {
    const double middle = std::floor(0.5 * (too_few + most));
    (is_enough(middle) ? most : too_few) = middle;
  }
  return most;
}

}  // namespace

MoreNeeded more_needed(const Comparison& comparison, int recordings, double level) {
  MoreNeeded needed;
  if (!comparison.known()) return needed;
  const double n = comparison.n, c = std::min(comparison.correlation, 1.0);
  const double variance = std::pow(comparison.standard_error, 2.0);
  const double of_one = variance * n / (1.0 + (n - 1.0) * c);
  // Of the mean's variance.
  const auto wanted = [&](double freedom) {
    return std::pow(comparison.difference / (student_quantile(1.0 - 0.5 * level, freedom) +
                                             student_quantile(0.8, freedom)),
                    2.0);
  };
  // Of so many recordings, with so many values more than now. From kOwnSpread on the spread is
  // that of their means alone: the third takes away what halves and replicates had said.
  const auto freedom_of = [&](double all, double more) {
    return all >= kOwnSpread ? all - 1.0 : std::max(1.0, comparison.freedom + more);
  };
  needed.recordings = least_from(recordings, [&](double all) {
    return variance * recordings / all <= wanted(freedom_of(all, all - recordings));
  });
  needed.replicates = least_from(n, [&](double all) {
    return of_one * (1.0 + (all - 1.0) * c) / all <= wanted(freedom_of(recordings, all - n));
  });
  return needed;
}

std::string_view verdict_name(Verdict verdict) {
  constexpr std::array<std::string_view, 5> kNames = {"not compared", "identical", "undecided",
                                                      "better", "worse"};
  return kNames[static_cast<std::size_t>(verdict)];
}

Verdict verdict_of(const Comparison& comparison, double p, double significance) {
  if (!comparison.known()) return Verdict::kUnknown;
  if (comparison.identical) return Verdict::kIdentical;
  if (!(p < significance)) return Verdict::kUndecided;
  return comparison.difference < 0.0 ? Verdict::kBetter : Verdict::kWorse;
}

namespace {

// Places of those that are known, the smallest first.
std::vector<std::size_t> ascending(std::span<const double> p) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!std::isnan(p[i])) order.push_back(i);
  }
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return p[i]; });
  return order;
}

}  // namespace

std::vector<double> holm_factors(std::span<const double> p, std::size_t family) {
  std::vector<double> factors(p.begin(), p.end());
  const std::vector<std::size_t> order = ascending(p);
  std::size_t left = family > 0 ? family : order.size();
  for (const std::size_t i : order)
    factors[i] = static_cast<double>(left--);
  return factors;
}

Family family_of(std::span<const Comparison> comparisons, std::span<const double> p,
                 std::size_t family) {
  SPOOL_CHECK_EQ(comparisons.size(), p.size());
  std::vector<double> members(p.begin(), p.end());
  for (std::size_t i = 0; i < members.size(); ++i) {
    if (!comparisons[i].identical) continue;
    members[i] = std::numeric_limits<double>::quiet_NaN();
    if (family > 0) --family;
  }
  Family found{holm_adjusted(members, family), holm_factors(members, family)};
  for (std::size_t i = 0; i < members.size(); ++i) {
    if (!comparisons[i].identical) continue;
    found.p[i] = p[i];
    found.factors[i] = 1.0;
  }
  return found;
}

std::vector<double> holm_adjusted(std::span<const double> p, std::size_t family) {
  const std::vector<double> factors = holm_factors(p, family);
  std::vector<double> adjusted(p.begin(), p.end());
  double largest = 0.0;
  for (const std::size_t i : ascending(p)) {
    largest = std::max(largest, std::min(1.0, p[i] * factors[i]));
    adjusted[i] = largest;
  }
  return adjusted;
}

}  // namespace spool
