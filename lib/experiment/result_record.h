// What is kept of a finished cell: the fields of its row, and how many samples its pixels took, so
// that methods can be compared later, by another process too.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/experiment/experiment.h"

namespace spool {

// Metrics that methods are ranked by.
const std::vector<std::string>& compared_metrics();
// Those of where samples are.
const std::vector<std::string>& density_quantities();
// Those that a claim may ask of: all of these.
std::vector<std::string> claimed_metrics();
// Wall time: of that list, what depends on the machine.
bool is_time(std::string_view metric);

struct ResultRecord {
  std::vector<std::string> fields;                // as result_columns()
  std::vector<std::pair<int, long long>> counts;  // as SamplingDensity::counts; empty: not known

  std::vector<MetricHalves> halves;  // as CellResult::halves

  const std::string& text(std::string_view column) const;
  double number(std::string_view column) const;  // NaN where the field is empty
  double number(std::size_t column) const;       // the same of column_index(name)
  // There is no result, or pixels are missing in it.
  bool failed() const { return !text("error").empty(); }
};

ResultRecord record_of(const CellResult& result);

}  // namespace spool
