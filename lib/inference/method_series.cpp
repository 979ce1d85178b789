#include "lib/inference/method_series.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lib/core/check.h"
#include "lib/core/random.h"
#include "lib/inference/intervals.h"
#include "lib/metrics/bootstrap.h"

namespace spool {
namespace {

constexpr double kNormal95 = 1.959963984540054;
constexpr double kManyFreedom = 1e6;  // Student's distribution is normal to nine digits

double mean_of(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values)
    sum += value;
  return sum / static_cast<double>(values.size());
}

double variance_of(std::span<const double> values) {
  const double deviation = standard_error_of(values);
  return std::isfinite(deviation) ? deviation * deviation : 0.0;
}

// Of a sum of two independent estimates of variance [Satterthwaite46].
double freedom_of_sum(double a, double freedom_a, double b, double freedom_b) {
  const double sum = a + b;
  const double spread = a * a / freedom_a + b * b / freedom_b;
  return spread > 0.0 ? std::max(1.0, sum * sum / spread) : std::numeric_limits<double>::infinity();
}

}  // namespace

MethodSeries method_series(std::string name, std::string_view metric,
                           std::span<const MetricTable* const> replicates) {
  const int index = metric_index(metric);
  SPOOL_CHECK_GE(index, 0);
  const auto m = static_cast<std::size_t>(index);
  MethodSeries series{std::move(name), {}, {}};
  for (const MetricTable* table : replicates) {
    series.values.push_back(table->values[m].value);
    series.resampled.push_back(table->resampled[m]);
    series.blocks = table->blocks;
  }
  return series;
}

MethodSeries difference_of(const MethodSeries& a, const MethodSeries& b) {
  SPOOL_CHECK_EQ(a.values.size(), b.values.size());
  MethodSeries difference{a.name + " - " + b.name, {}, {}, std::min(a.blocks, b.blocks)};
  for (std::size_t r = 0; r < a.values.size(); ++r) {
    difference.values.push_back(a.values[r] - b.values[r]);
    std::vector<double>& resampled = difference.resampled.emplace_back();
    for (std::size_t s = 0; s < std::min(a.resampled[r].size(), b.resampled[r].size()); ++s)
      resampled.push_back(a.resampled[r][s] - b.resampled[r][s]);
  }
  return difference;
}

double ResampledMean::reach() const {
  return freedom < kManyFreedom ? student_quantile(0.975, freedom) : kNormal95;
}

ResampledMean resampled_mean(const MethodSeries& series, std::uint64_t seed) {
  ResampledMean result;
  std::vector<double> values;
  std::vector<std::vector<double>> deviations;  // [replicate][resample]
  std::size_t resamples = static_cast<std::size_t>(-1);
  for (std::size_t r = 0; r < series.values.size(); ++r) {
    if (!std::isfinite(series.values[r])) continue;
    values.push_back(series.values[r]);
    std::vector<double>& of_replicate = deviations.emplace_back();
    if (r < series.resampled.size()) of_replicate = series.resampled[r];
    for (double& value : of_replicate)
      value -= values.back();
    resamples = std::min(resamples, of_replicate.size());
  }
  if (values.empty()) return result;
  result.mean = mean_of(values);
  if (resamples == 0) return result;
  const auto n = static_cast<double>(values.size());
  const double block_freedom =
      series.blocks > 0 ? series.blocks - 1.0 : std::numeric_limits<double>::infinity();
  // A draw with replacement from B blocks has (B - 1) / B of their variance.
  const double correction = series.blocks > 1 ? std::sqrt(series.blocks / block_freedom) : 1.0;

  std::vector<double> blocks(resamples, 0.0);
  double within = 0.0;
  for (std::vector<double>& of_replicate : deviations) {
    of_replicate.resize(resamples);
    for (std::size_t s = 0; s < resamples; ++s) {
      of_replicate[s] *= correction;
      blocks[s] += of_replicate[s] / n;
    }
    within += variance_of(of_replicate) / n;
  }
  const double of_blocks = variance_of(blocks);
  double of_replicates = 0.0, scale = 0.0;
  if (values.size() > 1) {
    const double between = variance_of(values) / n;
    const double noise = std::max(0.0, within - of_blocks) / (n - 1.0);
    of_replicates = std::max(0.0, between - noise);
    // A draw with replacement from n replicates has (n - 1) / n of their variance.
    if (of_replicates > 0.0) scale = std::sqrt(of_replicates / between * n / (n - 1.0));
  }
  result.means.resize(resamples);
  for (std::size_t s = 0; s < resamples; ++s) {
    double drawn = 0.0;
    for (std::size_t draw = 0; draw < values.size(); ++draw)
      drawn += values[static_cast<std::size_t>(unit_double(mix(seed, s, draw)) * n)] - result.mean;
    result.means[s] = result.mean + blocks[s] + scale * drawn / n;
  }
  if (resamples < 2) return result;
  result.standard_error = std::sqrt(of_blocks + of_replicates);
  result.freedom = freedom_of_sum(of_blocks, std::max(1.0, block_freedom), of_replicates,
                                  std::max(1.0, n - 1.0));
  return result;
}

std::vector<double> stretched_means(const ResampledMean& resampled) {
  const double factor = resampled.reach() / kNormal95;
  std::vector<double> means = resampled.means;
  for (double& value : means)
    value = resampled.mean + factor * (value - resampled.mean);
  return means;
}

}  // namespace spool
