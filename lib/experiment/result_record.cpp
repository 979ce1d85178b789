#include "lib/experiment/result_record.h"

#include <charconv>
#include <cstdlib>

#include "lib/experiment/result_table.h"

namespace spool {

const std::vector<std::string>& compared_metrics() {
  static const std::vector<std::string> names = {"relmse", "mse",      "relmse_trimmed",
                                                 "smape",  "flip_ldr", "energy_ratio"};
  return names;
}

std::vector<std::string> claimed_metrics() {
  std::vector<std::string> names = compared_metrics();
  names.insert(names.end(), density_quantities().begin(), density_quantities().end());
  names.insert(names.end(), {"seconds_sampling", "seconds_filtering", "seconds_total"});
  return names;
}

bool is_time(std::string_view metric) {
  return metric.starts_with("seconds_");
}

const std::vector<std::string>& density_quantities() {
  static const std::vector<std::string> names = {"block_jump", "edge_share", "region_area"};
  return names;
}

const std::string& ResultRecord::text(std::string_view column) const {
  return fields[column_index(column)];
}

double ResultRecord::number(std::string_view column) const {
  return number(column_index(column));
}

double ResultRecord::number(std::size_t column) const {
  const std::string& field = fields[column];
  if (field.empty()) return std::nan("");
  double value = 0.0;
  const auto parsed = std::from_chars(field.data(), field.data() + field.size(), value);
  return parsed.ec == std::errc() ? value : std::strtod(field.c_str(), nullptr);
}

ResultRecord record_of(const CellResult& result) {
  return {result_fields(result), result.density.counts, result.halves};
}

}  // namespace spool
