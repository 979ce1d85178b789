// The methods of one scene and budget ranked by one metric, and that as JSON.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "lib/experiment/plan_cells.h"
#include "lib/inference/ranking.h"
#include "tools/batch/method_results.h"

namespace spool::tools {

struct Condition {
  std::string metric;
  double spp = 0;
  Ranking ranking;  // indices are those of the methods
  std::optional<std::size_t> baseline;
};

// The plan's, else uniform + box, where it is among the methods.
std::optional<std::size_t> baseline_of(const Plan& plan, const std::vector<MethodResults>& methods);

// None where no method has a value.
std::optional<Condition> rank_condition(const Plan& plan, const std::vector<MethodResults>& methods,
                                        const std::string& metric, double spp);

nlohmann::ordered_json condition_json(const Plan& plan, const PlanScene& scene,
                                      const std::vector<MethodResults>& methods,
                                      const Condition& condition);

// Of `method` to the other of the pair; nothing where errors were not compared by logarithms.
Interval ratio_of(const PairVerdict& pair, std::size_t method);

// Of two methods of which one has its verdict withheld: the ratio without an interval; else
// nothing.
Interval withheld_ratio(const MethodResults& method, const MethodResults& other,
                        const std::string& metric);

// [mean, low, high], [mean], or nothing.
nlohmann::ordered_json interval_json(const Interval& interval);
nlohmann::ordered_json json_number(double value);  // null where not finite
nlohmann::ordered_json names_of(const MethodResults& method);

}  // namespace spool::tools
