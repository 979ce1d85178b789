// Mean and comparison of series of replicates, for the generators of the pages: what
// statistics.json has no place for, by the same functions.
//
// One JSON object a line on standard input, one on standard output:
//   {"a": [...], "positive": true}  ->  {"n", "mean", "low", "high", "standard_error"}
//   {"a": [...], "b": [...]}        ->  {"ratio": [mean, low, high], "verdict": "better"}
//   {"ratios": [[mean, low, high], ...], "freedom": [3, ...]}  ->  {"verdicts": ["better", ...]}
// b has the same replicates; the verdict is of a against b, of this comparison alone at 5 %.
// Ratios with their 95 % intervals, as statistics.json has them, are judged together at 5 % (Holm).
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "formats/bounded_json.h"
#include "lib/inference/student.h"
#include "tools/batch/condition_json.h"

namespace spool {
namespace {

// Of a ratio whose logarithm has Student's interval of 95 %.
Comparison comparison_of(const std::vector<double>& ratio, double freedom) {
  Comparison c;
  c.logarithmic = true;
  c.difference = std::log(ratio.at(0));
  c.low = std::log(ratio.at(1));
  c.high = std::log(ratio.at(2));
  c.freedom = freedom;
  c.standard_error = (c.high - c.low) / 2.0 / student_quantile(0.975, freedom);
  c.p = c.difference == 0.0      ? 1.0
        : c.standard_error > 0.0 ? student_two_sided(c.difference / c.standard_error, freedom)
                                 : 0.0;
  return c;
}

nlohmann::ordered_json verdicts_of(const nlohmann::json& asked) {
  const auto ratios = asked.at("ratios").get<std::vector<std::vector<double>>>();
  const auto freedom = asked.at("freedom").get<std::vector<double>>();
  std::vector<Comparison> family;
  std::vector<double> p;
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    family.push_back(comparison_of(ratios[i], freedom.at(i)));
    p.push_back(family.back().p);
  }
  p = holm_adjusted(p);
  nlohmann::ordered_json verdicts = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < family.size(); ++i)
    verdicts.push_back(verdict_name(verdict_of(family[i], p[i])));
  return verdicts;
}

}  // namespace
}  // namespace spool

int main() {
  using namespace spool;
  std::string line;
  while (std::getline(std::cin, line)) {
    const auto asked = format::parse_json(line);
    if (asked.is_object() && asked.contains("ratios")) {
      const nlohmann::ordered_json verdicts = {{"verdicts", verdicts_of(asked)}};
      std::cout << verdicts.dump() << std::endl;
      continue;
    }
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
