// What people read about a metric.
#pragma once

#include <string>

namespace spool {

enum class Better { kLower, kHigher, kOne };

struct MetricDescription {
  std::string name;     // also the column of every table
  std::string meaning;  // one line
  Better better = Better::kLower;
};

}  // namespace spool
