#include "lib/experiment/result_record.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "lib/core/check.h"
#include "lib/experiment/result_table.h"
#include "lib/metrics/bootstrap.h"

namespace spool {

const std::vector<std::string>& compared_metrics() {
  static const std::vector<std::string> names = {"mse",   "relmse",   "relmse_trimmed",
                                                 "smape", "flip_ldr", "energy_ratio"};
  return names;
}

const std::string& ResultRecord::text(std::string_view column) const {
  return fields[column_index(column)];
}

double ResultRecord::number(std::string_view column) const {
  const std::string& field = text(column);
  return field.empty() ? std::nan("") : std::strtod(field.c_str(), nullptr);
}

int ResultRecord::blocks() const {
  const double width = number("width"), height = number("height");
  if (!(width > 0.0 && height > 0.0)) return 0;
  return BlockBootstrap(static_cast<int>(width), static_cast<int>(height), {.resamples = 0})
      .blocks();
}

ResultRecord record_of(const CellResult& result) {
  ResultRecord record{result_fields(result), {}};
  for (const std::string& name : compared_metrics()) {
    std::vector<float>& deviations = record.deviations.emplace_back();
    const auto m = static_cast<std::size_t>(metric_index(name));
    if (result.error || m >= result.metrics.resampled.size()) continue;
    for (const double value : result.metrics.resampled[m])
      deviations.push_back(static_cast<float>(value - result.metrics.values[m].value));
  }
  return record;
}

MethodSeries record_series(std::string name, std::string_view metric,
                           std::span<const ResultRecord* const> replicates) {
  const auto& known = compared_metrics();
  const auto found = std::ranges::find(known, metric);
  SPOOL_CHECK(found != known.end());
  const auto m = static_cast<std::size_t>(found - known.begin());
  MethodSeries series{std::move(name), {}, {}};
  for (const ResultRecord* record : replicates) {
    const double value = record->number(metric);
    series.values.push_back(value);
    series.blocks = record->blocks();
    std::vector<double>& resampled = series.resampled.emplace_back();
    if (m >= record->deviations.size()) continue;
    for (const float deviation : record->deviations[m])
      resampled.push_back(value + static_cast<double>(deviation));
  }
  return series;
}

}  // namespace spool
