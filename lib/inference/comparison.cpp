#include "lib/inference/comparison.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "lib/core/check.h"
#include "lib/inference/intervals.h"

namespace spool {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Values as distances that are better when lower.
MethodSeries as_cost(MethodSeries series, Better better) {
  const auto cost = [better](double value) {
    if (better == Better::kHigher) return -value;
    return better == Better::kOne ? std::abs(value - 1.0) : value;
  };
  for (double& value : series.values)
    value = cost(value);
  for (std::vector<double>& replicate : series.resampled) {
    for (double& value : replicate)
      value = cost(value);
  }
  return series;
}

double mean_of_finite(std::span<const double> values) {
  double sum = 0.0, n = 0.0;
  for (const double value : values) {
    if (std::isfinite(value)) sum += value, n += 1.0;
  }
  return n > 0.0 ? sum / n : kNaN;
}

// Two-sided. A difference without any spread is certain.
double p_of_no_difference(const ResampledMean& found) {
  if (found.mean == 0.0) return 1.0;
  const double z = quotient(std::abs(found.mean), found.standard_error);
  if (std::isinf(z)) return 0.0;
  if (found.freedom > 1e6) return std::erfc(z / std::sqrt(2.0));
  return 2.0 * student_cdf(-z, found.freedom);
}

}  // namespace

PairedComparison compare_paired(const MethodSeries& a, const MethodSeries& b, std::uint64_t seed) {
  const ResampledMean found = resampled_mean(difference_of(a, b), seed);
  PairedComparison comparison{found.mean, found.standard_error, kNaN, kNaN, 1.0};
  if (!std::isfinite(found.standard_error)) return comparison;
  const double reach = found.reach() * found.standard_error;
  comparison.low = found.mean - reach;
  comparison.high = found.mean + reach;
  if (found.mean != 0.0) comparison.p = p_of_no_difference(found);
  return comparison;
}

std::vector<double> holm_adjusted(std::span<const double> p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return p[i] < p[j]; });
  std::vector<double> adjusted(p.size());
  double largest = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    largest = std::max(largest, std::min(1.0, p[order[k]] * static_cast<double>(p.size() - k)));
    adjusted[order[k]] = largest;
  }
  return adjusted;
}

std::vector<RankedMethod> rank_methods(std::span<const MethodSeries> methods, Better better,
                                       double significance, std::uint64_t seed) {
  std::vector<MethodSeries> costs;
  std::vector<RankedMethod> ranked;
  for (std::size_t i = 0; i < methods.size(); ++i) {
    costs.push_back(as_cost(methods[i], better));
    ranked.push_back({i, mean_of_finite(methods[i].values), 1, 1.0});
  }
  std::vector<double> mean_cost, p;
  for (const MethodSeries& cost : costs)
    mean_cost.push_back(mean_of_finite(cost.values));
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < costs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      pairs.emplace_back(i, j);
      p.push_back(compare_paired(costs[i], costs[j], seed).p);
    }
  }
  const std::vector<double> adjusted = holm_adjusted(p);
  // A method without any finite value comes last.
  const auto cost_of = [&](std::size_t i) {
    return std::isnan(mean_cost[i]) ? std::numeric_limits<double>::infinity() : mean_cost[i];
  };
  std::size_t best = 0;
  for (std::size_t i = 1; i < costs.size(); ++i) {
    if (cost_of(i) < cost_of(best)) best = i;
  }
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const auto [i, j] = pairs[k];
    if (i == best || j == best) ranked[i == best ? j : i].p_against_best = adjusted[k];
    if (adjusted[k] < significance) ++ranked[cost_of(i) > cost_of(j) ? i : j].rank;
  }
  std::stable_sort(ranked.begin(), ranked.end(), [&](const RankedMethod& a, const RankedMethod& b) {
    return cost_of(a.method) < cost_of(b.method);
  });
  return ranked;
}

std::vector<RankedMethod> rank_against_best(std::span<const MethodSeries> methods, Better better,
                                            double significance, std::uint64_t seed) {
  std::vector<MethodSeries> costs;
  std::vector<double> cost;
  std::vector<RankedMethod> ranked;
  for (std::size_t i = 0; i < methods.size(); ++i) {
    costs.push_back(as_cost(methods[i], better));
    const double mean = mean_of_finite(costs[i].values);
    cost.push_back(std::isnan(mean) ? std::numeric_limits<double>::infinity() : mean);
    ranked.push_back({i, mean_of_finite(methods[i].values), 1, 1.0});
  }
  std::stable_sort(ranked.begin(), ranked.end(), [&](const RankedMethod& a, const RankedMethod& b) {
    return cost[a.method] < cost[b.method];
  });
  std::vector<double> p;
  for (std::size_t k = 1; k < ranked.size(); ++k)
    p.push_back(compare_paired(costs[ranked[k].method], costs[ranked[0].method], seed).p);
  const std::vector<double> adjusted = holm_adjusted(p);
  for (std::size_t k = 1; k < ranked.size(); ++k) {
    ranked[k].p_against_best = adjusted[k - 1];
    if (adjusted[k - 1] < significance) ranked[k].rank = 2;
  }
  return ranked;
}

BudgetFit fit_error_over_budget(std::span<const double> budget, std::span<const double> error) {
  SPOOL_CHECK_EQ(budget.size(), error.size());
  std::vector<double> x, y;
  for (std::size_t i = 0; i < budget.size(); ++i) {
    if (!(budget[i] > 0.0 && error[i] > 0.0) || !std::isfinite(error[i])) continue;
    x.push_back(std::log(budget[i]));
    y.push_back(std::log(error[i]));
  }
  BudgetFit fit{static_cast<int>(x.size()), kNaN, kNaN, kNaN};
  const double mx = mean_of_finite(x), my = mean_of_finite(y);
  double xx = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mx) * (x[i] - mx);
    xy += (x[i] - mx) * (y[i] - my);
  }
  if (!(xx > 0.0)) return fit;
  fit.slope = xy / xx;
  fit.intercept = my - fit.slope * mx;
  if (x.size() < 3) return fit;
  double residual = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double r = y[i] - fit.intercept - fit.slope * x[i];
    residual += r * r;
  }
  fit.slope_standard_error = std::sqrt(residual / static_cast<double>(x.size() - 2) / xx);
  return fit;
}

}  // namespace spool
