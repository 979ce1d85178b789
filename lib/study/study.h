// What the results of a plan say about its methods: the one place where means, intervals, ratios,
// ranks and verdicts come from. Everything that prints them prints these.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lib/study/claim_findings.h"
#include "lib/study/condition.h"
#include "lib/study/curve.h"

namespace spool {

// One method at one place: every quantity.
struct MethodFinding {
  StudyPlace place;
  MethodPair methods;
  std::string sampler_name, filter_name;  // without preset, options and label
  int replicates = 0, failed = 0;
  bool one_image = false;
  double shared = 0, correlation = 0;  // as MethodResults
  std::string reference;
  std::vector<Interval> quantities;  // [quantity]; a mean that is NaN: not known
};

// Means over the scenes, which are taken as given, of a method that all of them have: geometric of
// errors and times.
struct OverallFinding {
  // To the baseline, and on how many scenes it is better and worse.
  struct AgainstBaseline {
    Interval ratio;
    int better = 0, worse = 0, undecided = 0;
  };
  double spp = 0;
  int threads = 0;
  MethodPair methods;
  std::vector<Interval> quantities;  // [quantity]; a mean that is NaN: not known
  // By metric, of those where all scenes have both.
  std::vector<std::pair<std::string, AgainstBaseline>> against;
};

struct Study {
  std::string baseline;  // baseline_name()
  std::vector<PlanScene> scenes;
  std::vector<ClaimFinding> claims;
  std::vector<MethodFinding> results;        // per scene, budget, threads and method
  std::vector<ConditionFinding> conditions;  // per scene, budget, threads and metric
  std::vector<CurveFinding> curves;          // per scene, threads and method
  std::vector<OverallFinding> overall;       // per budget, threads and method
};

Study study_of(const Plan& plan, const StudySources& sources);

}  // namespace spool
