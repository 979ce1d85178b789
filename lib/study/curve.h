// One method over the budgets: the slope of its error, and what it needs for the baseline's.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lib/inference/budget_curve.h"
#include "lib/inference/equal_time.h"
#include "lib/study/method_results.h"
#include "lib/study/place.h"

namespace spool {

// What follows where the baseline has `at` samples per pixel.
struct NeededAt {
  double at = 0;
  SamplesNeeded needed;
};
struct EqualTimeAt {
  double at = 0;
  double seconds = 0;  // processor time of the baseline
  EqualTime found;
};

struct CurveFinding {
  std::string recording;
  int threads = 0;
  std::string group;  // of the scene
  MethodPair methods;
  bool biased = false;
  std::string metric;
  std::vector<double> budgets;  // those with a value, ascending
  Interval slope;
  bool against_baseline = false;  // false: it is the baseline, or there is none
  std::vector<NeededAt> needed;
  std::vector<EqualTimeAt> equal_time;
};

// `spp`: of the plan. `budgets`: [budget][method]. None where fewer than two budgets have a value.
std::optional<CurveFinding> curve_finding(std::span<const double> spp,
                                          const std::vector<std::vector<MethodResults>>& budgets,
                                          std::size_t method, std::optional<std::size_t> baseline,
                                          const std::string& metric);

}  // namespace spool
