#include "lib/metrics/metric_table.h"

#include "lib/core/check.h"
#include "lib/metrics/metric_description.h"

namespace spool {

const MetricValue& MetricTable::operator[](std::string_view name) const {
  const int index = metric_index(name);
  SPOOL_CHECK_GE(index, 0);
  SPOOL_CHECK_LT(static_cast<std::size_t>(index), values.size());
  return values[static_cast<std::size_t>(index)];
}

}  // namespace spool
