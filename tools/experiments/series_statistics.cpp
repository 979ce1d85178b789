// Mean and comparison of series of replicates, for the generators of the pages: what
// statistics.json has no place for, by the same functions.
//
// One JSON object a line on standard input, one on standard output:
//   {"a": [...], "positive": true}  ->  {"n", "mean", "low", "high", "standard_error"}
//   {"a": [...], "b": [...]}        ->  {"ratio": [mean, low, high], "verdict": "better"}
// b has the same replicates; the verdict is of a against b, of this comparison alone at 5 %.
#include <iostream>
#include <string>

#include <nlohmann/json.hpp>

#include "formats/bounded_json.h"
#include "tools/batch/condition_json.h"

int main() {
  using namespace spool;
  std::string line;
  while (std::getline(std::cin, line)) {
    const auto asked = format::parse_json(line);
    if (!asked.is_object() || !asked.contains("a")) return 2;
    const Series a{asked["a"].get<std::vector<double>>()};
    nlohmann::ordered_json answer;
    if (asked.contains("b")) {
      const Series b{asked["b"].get<std::vector<double>>()};
      if (a.values.size() != b.values.size()) return 2;
      const Comparison found = compare_paired(a, b, Better::kLower);
      answer = {{"ratio", tools::interval_json(found.ratio())},
                {"verdict", verdict_name(verdict_of(found, found.p))}};
    } else {
      const Range range = asked.value("positive", false) ? Range::kPositive : Range::kReal;
      const Interval found = mean_interval(a, range);
      answer = {{"n", found.n},
                {"mean", tools::json_number(found.mean)},
                {"low", tools::json_number(found.low)},
                {"high", tools::json_number(found.high)},
                {"standard_error", tools::json_number(found.standard_error)}};
    }
    std::cout << answer.dump() << std::endl;
  }
  return 0;
}
