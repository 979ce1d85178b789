// The methods of one place ranked by one metric.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/experiment/plan_cells.h"
#include "lib/inference/ranking.h"
#include "lib/study/method_results.h"
#include "lib/study/place.h"

namespace spool {

struct Condition {
  std::string metric;
  double spp = 0;
  Ranking ranking;  // indices are those of the methods
  std::optional<std::size_t> baseline;
};

// What every other method is compared with where the plan names none: the same number of samples
// everywhere, and their mean.
inline constexpr std::string_view kBaseline = "uniform + box";
// Of the methods, in the order samplers, then filters: the one whose name, by its labels, is the
// baseline's; else the only one whose name is, without presets, options and labels.
std::optional<std::size_t> baseline_of(const Plan& plan);
// Of that method; what was asked for, where there is none.
std::string baseline_name(const Plan& plan);

// None where no method has a value.
std::optional<Condition> rank_condition(const Plan& plan, const std::vector<MethodResults>& methods,
                                        const std::string& metric, double spp);

// The ratio to the condition's baseline, which there must be: of their pair, else withheld_ratio.
Interval baseline_ratio(const Condition& condition, const std::vector<MethodResults>& methods,
                        std::size_t method);

// How much more would separate a method and the baseline: replicates, or recordings where
// replicates would repeat their samples.
struct WouldDecide {
  double count = 0;
  bool recordings = false;

  const char* unit() const { return recordings ? "recordings" : "replicates"; }
};

// One method as the ranking has it.
struct RankedFinding {
  std::size_t result = 0;  // index into Study::results
  Interval value;
  std::optional<Interval> order;  // about another order of the same samples
  std::string letters;
  bool compared = true;
  Withheld withheld = Withheld::kNo;
  std::optional<Verdict> against_best;  // none: it is the best, or not compared
  std::optional<double> p_against_best;
  std::optional<Verdict> against_baseline;  // none: it is the baseline, or there is none
  std::optional<Interval> ratio;            // to the baseline
  Withheld baseline_withheld = Withheld::kNo;
  std::optional<WouldDecide> would_decide;
  Interval energy;
  std::optional<double> loses_energy;  // the share that is lost, where beyond the interval
};

// Two methods by their places in the ranking, the better mean first.
struct PairFinding {
  std::size_t first = 0, second = 0;
  Interval ratio;
  double p = 1;  // adjusted for all pairs
  Verdict verdict = Verdict::kUnknown;
};

// What the intervals and verdicts are about.
struct About {
  std::string kind;
  double shared = 0;  // most of a replicate's samples that another took too, over the methods
  std::string text;
};

struct ConditionFinding {
  StudyPlace place;
  std::string metric;
  bool biased = false;
  About about;
  std::vector<RankedFinding> ranking;             // best first
  std::optional<std::vector<PairFinding>> pairs;  // of mse and relmse
};

// `results`: [method] index into Study::results; methods without a finished result are left out.
ConditionFinding condition_finding(const Plan& plan, const PlanScene& scene,
                                   const std::vector<MethodResults>& methods,
                                   const std::vector<std::size_t>& results,
                                   const Condition& condition);

}  // namespace spool
