#include "lib/inference/budget_curve.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "lib/core/check.h"

namespace spool {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double mean_of_finite(std::span<const double> values) {
  double sum = 0.0;
  int n = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    sum += value;
    ++n;
  }
  return n > 0 ? sum / n : kNaN;
}

// 2.5 and 97.5 % of the values that are numbers; infinite ones count as the ends they are.
std::pair<double, double> percentile_interval(std::vector<double> values) {
  std::erase_if(values, [](double value) { return std::isnan(value); });
  if (values.size() < 40) return {kNaN, kNaN};
  std::ranges::sort(values);
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
  };
  return {at(0.025), at(0.975)};
}

// -inf: reached at the first budget already; +inf: not reached at the last.
double crossing(std::span<const double> spp, std::span<const double> errors, double target) {
  if (!std::isfinite(target)) return kNaN;
  double last_spp = kNaN, last_error = kNaN;
  for (std::size_t i = 0; i < spp.size(); ++i) {
    if (!std::isfinite(errors[i])) continue;
    if (errors[i] <= target) {
      if (std::isnan(last_spp)) return -std::numeric_limits<double>::infinity();
      // An error that is not positive has no logarithm: the step is taken whole.
      if (!(errors[i] > 0.0)) return spp[i];
      const double share = std::log(last_error / target) / std::log(last_error / errors[i]);
      return last_spp * std::pow(spp[i] / last_spp, share);
    }
    last_spp = spp[i];
    last_error = errors[i];
  }
  return std::isnan(last_spp) ? kNaN : std::numeric_limits<double>::infinity();
}

struct ResampledCurve {
  std::vector<std::vector<double>> means;  // [budget][resample]
  std::size_t resamples = 0;

  explicit ResampledCurve(const BudgetCurve& curve, std::uint64_t seed) {
    for (const MethodSeries& series : curve.series) {
      means.push_back(stretched_means(resampled_mean(series, seed)));
      resamples =
          means.size() == 1 ? means.back().size() : std::min(resamples, means.back().size());
    }
  }
  std::vector<double> at(std::size_t resample) const {
    std::vector<double> errors;
    for (const std::vector<double>& budget : means)
      errors.push_back(budget[resample]);
    return errors;
  }
};

std::vector<double> means_of(const BudgetCurve& curve) {
  std::vector<double> errors;
  for (const MethodSeries& series : curve.series)
    errors.push_back(mean_of_finite(series.values));
  return errors;
}

}  // namespace

ErrorSlope error_slope(const BudgetCurve& curve, std::uint64_t seed) {
  SPOOL_CHECK_EQ(curve.spp.size(), curve.series.size());
  ErrorSlope slope{fit_error_over_budget(curve.spp, means_of(curve)), kNaN, kNaN};
  const ResampledCurve resampled(curve, seed);
  std::vector<double> slopes;
  for (std::size_t s = 0; s < resampled.resamples; ++s)
    slopes.push_back(fit_error_over_budget(curve.spp, resampled.at(s)).slope);
  std::tie(slope.low, slope.high) = percentile_interval(std::move(slopes));
  return slope;
}

SamplesNeeded samples_needed(const BudgetCurve& curve, const MethodSeries& target,
                             std::uint64_t seed) {
  SPOOL_CHECK_EQ(curve.spp.size(), curve.series.size());
  const double found = crossing(curve.spp, means_of(curve), mean_of_finite(target.values));
  if (std::isnan(found)) return {kNaN, kNaN, kNaN, false, false};
  SamplesNeeded needed{kNaN, kNaN, kNaN, found < 0.0, found > 0.0 && std::isinf(found)};
  const auto in_range = [&](double spp) {
    return std::clamp(spp, curve.spp.front(), curve.spp.back());
  };
  needed.spp = in_range(found);
  const ResampledCurve resampled(curve, seed);
  const std::vector<double> targets = stretched_means(resampled_mean(target, seed));
  std::vector<double> crossings;
  for (std::size_t s = 0; s < std::min(resampled.resamples, targets.size()); ++s)
    crossings.push_back(crossing(curve.spp, resampled.at(s), targets[s]));
  const auto [low, high] = percentile_interval(std::move(crossings));
  if (!std::isnan(low)) {
    needed.low = in_range(low);
    needed.high = in_range(high);
  }
  return needed;
}

}  // namespace spool
