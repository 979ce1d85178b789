#include "lib/inference/budget_curve.h"

#include <algorithm>
#include <cmath>

#include "lib/core/check.h"
#include "lib/inference/log_combination.h"

namespace spool {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kStepsPerBudget = 64;  // of the search for the ends of an interval

double log_or_nan(double value) {
  return value > 0.0 && std::isfinite(value) ? std::log(value) : kNaN;
}

// Error less target, both logarithms, at a place between the budgets.
Series gap_at(const BudgetCurve& curve, const Series& target, std::size_t left, double share) {
  return log_combination(std::vector<WeightedSeries>{
      {1.0 - share, &curve.series[left]}, {share, &curve.series[left + 1]}, {-1.0, &target}});
}

// Budgets from the smallest to the largest at which the gap is looked at, each with its gap.
struct Place {
  double spp;
  Interval gap;
};
std::vector<Place> places_of(const BudgetCurve& curve, const Series& target) {
  std::vector<Place> places;
  for (std::size_t left = 0; left + 1 < curve.spp.size(); ++left) {
    const double from = std::log(curve.spp[left]), to = std::log(curve.spp[left + 1]);
    const bool last = left + 2 == curve.spp.size();
    for (int step = 0; step < kStepsPerBudget + (last ? 1 : 0); ++step) {
      const double share = static_cast<double>(step) / kStepsPerBudget;
      const double spp = step == kStepsPerBudget ? curve.spp.back()
                         : step == 0             ? curve.spp[left]
                                                 : std::exp(from + share * (to - from));
      places.push_back({spp, interval_of_logs(gap_at(curve, target, left, share))});
    }
  }
  return places;
}

// Where a line through two places reaches zero; straight over log spp.
double crossing(const Place& above, const Place& below, double from, double to) {
  const double share = from / (from - to);
  return above.spp * std::pow(below.spp / above.spp, share);
}

}  // namespace

double log_slope(std::span<const double> budget, std::span<const double> error) {
  SPOOL_CHECK_EQ(budget.size(), error.size());
  double n = 0.0, mx = 0.0, my = 0.0, xx = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < budget.size(); ++i) {
    const double x = log_or_nan(budget[i]), y = log_or_nan(error[i]);
    if (std::isnan(x) || std::isnan(y)) continue;
    n += 1.0;
    const double dx = x - mx;
    mx += dx / n;
    my += (y - my) / n;
    xx += dx * (x - mx);
    xy += dx * (y - my);
  }
  return xx > 0.0 ? xy / xx : kNaN;
}

Interval error_slope(const BudgetCurve& curve) {
  SPOOL_CHECK_EQ(curve.spp.size(), curve.series.size());
  const bool positive = std::ranges::all_of(
      curve.series, [](const Series& series) { return all_positive(series.values); });
  if (curve.series.empty() || !positive) return {};
  // The spread is that of the whole line; values are by replicate, as budgets may be missing.
  std::vector<WeightedSeries> line;
  for (std::size_t b = 0; b < curve.spp.size(); ++b) {
    std::vector<double> unit(curve.spp.size(), 1.0);
    unit[b] = std::exp(1.0);
    line.push_back({log_slope(curve.spp, unit), &curve.series[b]});
  }
  Series slopes = log_combination(line);
  for (std::size_t r = 0; r < slopes.values.size(); ++r) {
    std::vector<double> errors;
    for (const Series& series : curve.series)
      errors.push_back(series.values[r]);
    slopes.values[r] = log_slope(curve.spp, errors);
  }
  return interval_of_logs(slopes);
}

SamplesNeeded samples_needed(const BudgetCurve& curve, const Series& target) {
  SPOOL_CHECK_EQ(curve.spp.size(), curve.series.size());
  SamplesNeeded needed;
  if (curve.spp.size() < 2) return needed;
  const std::vector<Place> places = places_of(curve, target);
  const auto known = [](const Place& p) { return std::isfinite(p.gap.mean); };
  if (!std::ranges::all_of(places, known)) return needed;
  const auto reached = std::ranges::find_if(places, [](const Place& p) { return p.gap.mean <= 0; });
  needed.at_most = reached == places.begin();
  needed.more_than = reached == places.end();
  if (needed.at_most || needed.more_than) {
    needed.spp = needed.at_most ? curve.spp.front() : curve.spp.back();
  } else {
    const Place& above = *std::prev(reached);
    needed.spp = crossing(above, *reached, above.gap.mean, reached->gap.mean);
  }
  if (!std::isfinite(places.front().gap.low)) return needed;
  // The first place that may be it, and the first after which none may.
  const auto first = std::ranges::find_if(places, [](const Place& p) { return p.gap.low <= 0; });
  const auto last = std::ranges::find_if(places, [](const Place& p) { return p.gap.high < 0; });
  const auto end = [&](auto found, double Interval::* side) {
    if (found == places.begin()) return curve.spp.front();
    if (found == places.end()) return std::isnan(places.back().gap.low) ? kNaN : curve.spp.back();
    const Place& above = *std::prev(found);
    return crossing(above, *found, above.gap.*side, (*found).gap.*side);
  };
  needed.low = end(first, &Interval::low);
  needed.high = end(last, &Interval::high);
  // Beside a budget of one replicate, or of an interval that is withheld.
  if (std::isnan(needed.low + needed.high)) needed.low = needed.high = kNaN;
  needed.at_most = needed.at_most && last == places.begin();
  needed.more_than = needed.more_than && first == places.end();
  return needed;
}

}  // namespace spool
