// What people read about a metric.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace spool {

enum class Better { kLower, kHigher, kOne };

struct MetricDescription {
  std::string name;     // also the column of every table
  std::string meaning;  // one line
  Better better = Better::kLower;
};

// All metrics, in the order of every table.
const std::vector<MetricDescription>& metrics();
// Index into metrics(), or -1.
int metric_index(std::string_view name);
std::string_view better_name(Better better);  // lower, higher, near 1

// What is better of a metric; of any other quantity, a time or a count, less.
Better better_of(std::string_view quantity);

}  // namespace spool
