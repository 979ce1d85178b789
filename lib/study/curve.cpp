#include "lib/study/curve.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace spool {
namespace {

using Budgets = std::vector<std::vector<MethodResults>>;

BudgetCurve curve_of(std::span<const double> spp, const Budgets& budgets, std::size_t method,
                     std::size_t quantity) {
  std::vector<std::size_t> order(spp.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](std::size_t b) { return spp[b]; });
  BudgetCurve curve;
  for (const std::size_t b : order) {
    Series at = budgets[b][method].series(quantity);
    if (at.known() == 0) continue;
    curve.spp.push_back(spp[b]);
    curve.series.push_back(std::move(at));
  }
  return curve;
}

std::vector<NeededAt> needed(std::span<const double> spp, const Budgets& budgets,
                             const BudgetCurve& curve, std::size_t baseline, std::size_t quantity) {
  std::vector<NeededAt> list;
  for (std::size_t b = 0; b < spp.size(); ++b) {
    const SamplesNeeded found = samples_needed(curve, budgets[b][baseline].series(quantity));
    if (std::isfinite(found.spp)) list.push_back({spp[b], found});
  }
  return list;
}

std::vector<EqualTimeAt> at_equal_time(std::span<const double> spp, const Budgets& budgets,
                                       std::size_t method, std::size_t baseline,
                                       std::size_t quantity) {
  const std::size_t cpu = quantity_index(kCpuTotal);
  std::vector<Series> errors;
  for (const std::vector<MethodResults>& methods : budgets)
    errors.push_back(methods[method].series(quantity));
  std::vector<TimedError> curve;
  for (std::size_t b = 0; b < budgets.size(); ++b)
    curve.push_back({budgets[b][method].mean(cpu), &errors[b]});
  std::vector<EqualTimeAt> list;
  for (std::size_t b = 0; b < spp.size(); ++b) {
    const Series target = budgets[b][baseline].series(quantity);
    const double seconds = budgets[b][baseline].mean(cpu);
    const EqualTime found = equal_time(curve, {seconds, &target});
    if (found.too_slow || found.too_fast || found.known()) list.push_back({spp[b], seconds, found});
  }
  return list;
}

}  // namespace

std::optional<CurveFinding> curve_finding(std::span<const double> spp, const Budgets& budgets,
                                          std::size_t method, std::optional<std::size_t> baseline,
                                          const std::string& metric) {
  const std::size_t quantity = quantity_index(metric);
  const BudgetCurve curve = curve_of(spp, budgets, method, quantity);
  if (curve.spp.size() < 2) return std::nullopt;
  CurveFinding found;
  found.biased = budgets.front()[method].biased;
  found.metric = metric;
  found.budgets = curve.spp;
  found.slope = error_slope(curve);
  found.against_baseline = baseline && *baseline != method;
  if (found.against_baseline) {
    found.needed = needed(spp, budgets, curve, *baseline, quantity);
    found.equal_time = at_equal_time(spp, budgets, method, *baseline, quantity);
  }
  return found;
}

}  // namespace spool
