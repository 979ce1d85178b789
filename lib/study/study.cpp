#include "lib/study/study.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>

namespace spool {
namespace {

MethodPair pair_of(const MethodResults& method) {
  return {method.sampler.label(), method.filter.label()};
}

// One method on one scene at one budget.
struct MethodSummary {
  struct Against {
    Interval ratio;
    Verdict verdict = Verdict::kUnknown;
  };
  MethodPair methods;
  std::vector<Interval> quantities;        // [quantity]
  std::map<std::string, Against> against;  // the baseline, by metric
};
struct SceneSummary {
  int threads = 0;
  std::vector<std::vector<MethodSummary>> budgets;  // [budget][method]
};

// One scene with one number of threads, all budgets.
class SceneStudy {
 public:
  SceneStudy(const Plan& plan, const PlanScene& scene, int threads,
             std::vector<std::vector<MethodResults>> budgets)
      : plan_(plan), scene_(scene), threads_(threads), budgets_(std::move(budgets)) {
    for (std::size_t b = 0; b < budgets_.size(); ++b) {
      std::vector<std::vector<Interval>>& intervals = intervals_.emplace_back();
      for (const MethodResults& method : budgets_[b]) {
        std::vector<Interval>& of_method = intervals.emplace_back();
        for (std::size_t q = 0; q < quantities().size(); ++q)
          of_method.push_back(method.interval(q));
      }
      std::vector<Condition>& conditions = conditions_.emplace_back();
      for (const std::string& metric : compared_metrics()) {
        if (auto ranked = rank_condition(plan, budgets_[b], metric, plan.spp[b]))
          conditions.push_back(*ranked);
      }
    }
  }

  void add_findings(Study& study) const {
    for (std::size_t b = 0; b < budgets_.size(); ++b) {
      const std::vector<std::size_t> results = add_results(study.results, b);
      for (const Condition& condition : conditions_[b]) {
        study.conditions.push_back(
            condition_finding(plan_, scene_, budgets_[b], results, condition));
        study.conditions.back().place = place(b);
      }
    }
    if (plan_.spp.size() > 1) add_curves(study.curves);
  }

  // What the means over all scenes are made of.
  SceneSummary summary() const {
    SceneSummary found{threads_, {}};
    for (std::size_t b = 0; b < budgets_.size(); ++b) {
      std::vector<MethodSummary>& methods = found.budgets.emplace_back();
      for (std::size_t m = 0; m < budgets_[b].size(); ++m) {
        MethodSummary& method =
            methods.emplace_back(MethodSummary{pair_of(budgets_[b][m]), {}, {}});
        method.quantities = intervals_[b][m];
        for (const Condition& condition : conditions_[b]) {
          if (condition.baseline && *condition.baseline != m)
            method.against.emplace(condition.metric, against_baseline(b, m, condition));
        }
      }
    }
    return found;
  }

 private:
  StudyPlace place(std::size_t budget) const {
    return {scene_.recordings.front(), plan_.spp[budget], threads_, scene_.group};
  }

  MethodSummary::Against against_baseline(std::size_t budget, std::size_t method,
                                          const Condition& condition) const {
    return {baseline_ratio(condition, budgets_[budget], method),
            condition.ranking.between(method, *condition.baseline)};
  }

  // [method] index into `list`, of those that have a result.
  std::vector<std::size_t> add_results(std::vector<MethodFinding>& list, std::size_t budget) const {
    std::vector<std::size_t> indices;
    for (std::size_t m = 0; m < budgets_[budget].size(); ++m) {
      const MethodResults& method = budgets_[budget][m];
      indices.push_back(list.size());
      if (method.done + method.failed == 0) continue;
      list.push_back({place(budget), pair_of(method), method.sampler.name, method.filter.name,
                      method.done, method.failed, method.one_image(), method.shared,
                      method.correlation, method.reference, intervals_[budget][m]});
    }
    return indices;
  }

  void add_curves(std::vector<CurveFinding>& list) const {
    const std::optional<std::size_t> baseline = baseline_of(plan_);
    for (std::size_t m = 0; m < budgets_.front().size(); ++m) {
      for (const char* metric : {"relmse", "mse"}) {
        auto curve = curve_finding(plan_.spp, budgets_, m, baseline, metric);
        if (!curve) continue;
        curve->recording = scene_.recordings.front();
        curve->threads = threads_;
        curve->group = scene_.group;
        curve->methods = pair_of(budgets_.front()[m]);
        list.push_back(std::move(*curve));
      }
    }
  }

  const Plan& plan_;
  const PlanScene& scene_;
  int threads_;
  std::vector<std::vector<MethodResults>> budgets_;            // [budget][method]
  std::vector<std::vector<std::vector<Interval>>> intervals_;  // [budget][method][quantity]
  std::vector<std::vector<Condition>> conditions_;             // [budget][metric that is known]
};

// None where a scene does not have both.
std::optional<OverallFinding::AgainstBaseline> overall_against_baseline(
    const std::vector<SceneSummary>& scenes, std::size_t budget, std::size_t method,
    const std::string& metric) {
  std::vector<Interval> ratios;
  OverallFinding::AgainstBaseline found;
  for (const SceneSummary& scene : scenes) {
    const auto& known = scene.budgets[budget][method].against;
    const auto against = known.find(metric);
    if (against == known.end() || against->second.ratio.n == 0) return std::nullopt;
    ratios.push_back(against->second.ratio);
    found.better += against->second.verdict == Verdict::kBetter;
    found.worse += against->second.verdict == Verdict::kWorse;
    found.undecided += against->second.verdict == Verdict::kUndecided;
  }
  found.ratio = mean_of_intervals(ratios);
  return found;
}

// An error or a time that one of the scenes does not average on its logarithm has no mean over
// them.
Interval overall_interval(const std::vector<SceneSummary>& scenes, std::size_t budget,
                          std::size_t method, std::size_t quantity) {
  std::vector<Interval> intervals;
  for (const SceneSummary& scene : scenes)
    intervals.push_back(scene.budgets[budget][method].quantities[quantity]);
  const bool logarithms = quantities()[quantity].range == Range::kPositive;
  const bool all = std::ranges::all_of(intervals, &Interval::logarithmic);
  return all || !logarithms ? mean_of_intervals(intervals) : Interval{};
}

void add_overall(std::vector<OverallFinding>& list, const Plan& plan,
                 const std::vector<SceneSummary>& scenes) {
  if (scenes.size() < 2) return;
  for (std::size_t b = 0; b < plan.spp.size(); ++b) {
    for (std::size_t m = 0; m < scenes.front().budgets[b].size(); ++m) {
      const MethodPair& methods = scenes.front().budgets[b][m].methods;
      OverallFinding found{plan.spp[b], scenes.front().threads, methods, {}, {}};
      bool any = false;
      for (std::size_t q = 0; q < quantities().size(); ++q) {
        found.quantities.push_back(overall_interval(scenes, b, m, q));
        any = any || std::isfinite(found.quantities.back().mean);
      }
      if (!any) continue;
      for (const std::string& metric : compared_metrics()) {
        if (const auto against = overall_against_baseline(scenes, b, m, metric))
          found.against.emplace_back(metric, *against);
      }
      list.push_back(std::move(found));
    }
  }
}

}  // namespace

Study study_of(const Plan& plan, const StudySources& sources) {
  Study study;
  study.baseline = baseline_name(plan);
  study.scenes = scenes_of(plan);
  std::vector<PlaceClaims> places;
  // A plan may have more results than fit into memory: a scene at a time.
  std::vector<std::vector<SceneSummary>> scenes(plan.threads.size());
  for (const PlanScene& scene : study.scenes) {
    SceneMethods methods = read_scene(plan, scene, sources);
    for (std::size_t b = 0; b < plan.spp.size(); ++b)
      std::ranges::move(claims_at(plan, scene, b, methods), std::back_inserter(places));
    for (std::size_t t = 0; t < plan.threads.size(); ++t) {
      const SceneStudy found(plan, scene, plan.threads[t], std::move(methods[t]));
      found.add_findings(study);
      if (study.scenes.size() > 1) scenes[t].push_back(found.summary());
    }
  }
  for (const std::vector<SceneSummary>& of_threads : scenes)
    add_overall(study.overall, plan, of_threads);
  study.claims = claim_findings(plan, places);
  return study;
}

}  // namespace spool
