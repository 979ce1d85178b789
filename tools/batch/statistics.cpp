#include "tools/batch/statistics.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "lib/experiment/baseline.h"
#include "lib/experiment/plan_cells.h"
#include "lib/inference/budget_curve.h"
#include "lib/inference/equal_time.h"
#include "lib/inference/ranking.h"
#include "tools/batch/claims_json.h"
#include "tools/batch/condition_json.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

const char* const kRules[][2] = {
    {"mean",
     "Over the replicates; geometric where every value is positive, so that quotients of means are "
     "means of quotients."},
    {"interval",
     "95 %, each for itself, about another recording of the scene: Student's, of the logarithms "
     "where the mean is geometric, widened where replicates share samples. The reference is taken "
     "as given. `order_low` and `order_high`, where given, are about this recording in another "
     "order of its samples, and about nothing else."},
    {"verdict",
     "Methods are compared replicate by replicate on the logarithms of their errors; of all pairs "
     "of a scene, budget and metric together at 5 % (Holm). Methods that share a letter are not "
     "told apart."},
    {"claim",
     "A question of the plan: the ratio of two errors lies below its limit. The claims of a scene "
     "and budget together at 5 % (Holm), apart from the pairs. Over several places: holds where "
     "some hold and none is reversed."},
    {"ratio", "To the baseline at the same budget, with its interval for itself."},
    {"withheld",
     "Neither interval nor verdict: fewer than 20 pixels bear half of the error, those of "
     "independent replicates together (with fewer than three recordings), or, for relMSE, the "
     "relative variance of the reference is above 0.01."},
    {"would_tell",
     "Where a method and the baseline are not told apart: about how many replicates, or recordings "
     "where replicates would repeat their samples, tell a difference as measured in 80 % of "
     "attempts, by itself."},
    {"equal_time",
     "The error in the processor time of the baseline (sampling, filtering and, where recorded, "
     "rendering), read from the method's own budgets and never beyond them."},
    {"energy", "Methods whose energy ratio is below 0.98, beyond its interval, lose energy."}};

// One scene with one number of threads, all budgets.
class SceneStudy {
 public:
  SceneStudy(const Plan& plan, const PlanScene& scene, int threads, const ReadRecord& read)
      : plan_(plan), scene_(scene), threads_(threads) {
    for (const double spp : plan.spp)
      budgets_.push_back(read_methods(plan, scene, spp, threads, read));
    for (std::size_t b = 0; b < budgets_.size(); ++b) {
      std::vector<Condition>& conditions = conditions_.emplace_back();
      for (const std::string& metric : compared_metrics()) {
        if (auto ranked = rank_condition(plan, budgets_[b], metric, plan.spp[b]))
          conditions.push_back(*ranked);
      }
    }
  }

  void add_claims(std::vector<ClaimPlace>& places) const {
    for (std::size_t b = 0; b < budgets_.size(); ++b)
      places.push_back(judge_claims(plan_, scene_, plan_.spp[b], threads_, budgets_[b]));
  }

  void add_results(ordered_json& list) const {
    for (std::size_t b = 0; b < budgets_.size(); ++b) {
      for (const MethodResults& method : budgets_[b]) {
        if (method.done + method.failed == 0) continue;
        ordered_json entry = place(plan_.spp[b]);
        entry.update(names_of(method));
        entry["sampler_name"] = method.sampler.name;
        entry["filter_name"] = method.filter.name;
        entry["replicates"] = method.done;
        entry["failed"] = method.failed;
        entry["one_image"] = method.one_image();
        entry["shared"] = method.shared;
        entry["correlation"] = method.correlation;
        entry["reference"] = method.reference;
        for (std::size_t q = 0; q < quantities().size(); ++q) {
          ordered_json found = interval_json(method.interval(q));
          if (!found.empty()) entry["quantities"][quantities()[q].name] = std::move(found);
        }
        list.push_back(std::move(entry));
      }
    }
  }

  void add_conditions(ordered_json& list) const {
    for (std::size_t b = 0; b < budgets_.size(); ++b) {
      for (const Condition& condition : conditions_[b]) {
        ordered_json entry = place(plan_.spp[b]);
        entry.update(condition_json(plan_, scene_, budgets_[b], condition));
        list.push_back(std::move(entry));
      }
    }
  }

  void add_curves(ordered_json& list) const {
    if (plan_.spp.size() < 2) return;
    const std::optional<std::size_t> against = baseline_of(plan_, budgets_.front());
    for (std::size_t m = 0; m < budgets_.front().size(); ++m) {
      for (const char* metric : {"relmse", "mse"}) {
        const std::size_t quantity = quantity_index(metric);
        const BudgetCurve curve = curve_of(m, quantity);
        if (curve.spp.size() < 2) continue;
        ordered_json entry = {{"dump", scene_.recordings.front()}, {"threads", threads_}};
        entry.update(names_of(budgets_.front()[m]));
        entry["biased"] = budgets_.front()[m].biased;
        entry["metric"] = metric;
        entry["budgets"] = curve.spp;
        entry["slope"] = interval_json(error_slope(curve));
        if (against && *against != m) {
          entry["needed"] = needed(curve, *against, quantity);
          entry["equal_time"] = at_equal_time(m, *against, quantity);
        }
        list.push_back(std::move(entry));
      }
    }
  }

  int threads() const { return threads_; }
  const std::vector<MethodResults>& methods(std::size_t budget) const { return budgets_[budget]; }
  const Condition* condition(std::size_t budget, const std::string& metric) const {
    const auto found = std::ranges::find(conditions_[budget], metric, &Condition::metric);
    return found == conditions_[budget].end() ? nullptr : &*found;
  }

 private:
  ordered_json place(double spp) const {
    return {{"dump", scene_.recordings.front()}, {"spp", spp}, {"threads", threads_}};
  }

  BudgetCurve curve_of(std::size_t m, std::size_t quantity) const {
    std::vector<std::size_t> order(plan_.spp.size());
    for (std::size_t b = 0; b < order.size(); ++b)
      order[b] = b;
    std::ranges::sort(order, {}, [&](std::size_t b) { return plan_.spp[b]; });
    BudgetCurve curve;
    for (const std::size_t b : order) {
      Series at = budgets_[b][m].series(quantity);
      if (at.known() == 0) continue;
      curve.spp.push_back(plan_.spp[b]);
      curve.series.push_back(std::move(at));
    }
    return curve;
  }

  ordered_json needed(const BudgetCurve& curve, std::size_t baseline, std::size_t quantity) const {
    ordered_json list = ordered_json::array();
    for (std::size_t b = 0; b < plan_.spp.size(); ++b) {
      const Series target = budgets_[b][baseline].series(quantity);
      const SamplesNeeded found = samples_needed(curve, target);
      if (!std::isfinite(found.spp)) continue;
      list.push_back({{"at", plan_.spp[b]},
                      {"spp", found.spp},
                      {"low", json_number(found.low)},
                      {"high", json_number(found.high)},
                      {"bound", found.at_most ? "at most" : (found.more_than ? "more than" : "")}});
    }
    return list;
  }

  ordered_json at_equal_time(std::size_t m, std::size_t baseline, std::size_t quantity) const {
    const std::size_t cpu = quantity_index("cpu_total");
    std::vector<Series> errors;
    for (const std::vector<MethodResults>& methods : budgets_)
      errors.push_back(methods[m].series(quantity));
    std::vector<TimedError> curve;
    for (std::size_t b = 0; b < budgets_.size(); ++b)
      curve.push_back({budgets_[b][m].mean(cpu), &errors[b]});
    ordered_json list = ordered_json::array();
    for (std::size_t b = 0; b < plan_.spp.size(); ++b) {
      const Series target = budgets_[b][baseline].series(quantity);
      const double seconds = budgets_[b][baseline].mean(cpu);
      const EqualTime found = equal_time(curve, {seconds, &target});
      ordered_json entry = {{"at", plan_.spp[b]}, {"seconds", json_number(seconds)}};
      if (found.too_slow || found.too_fast) {
        entry["outside"] = found.too_slow ? "too slow" : "too fast";
      } else if (found.known()) {
        entry["ratio"] = interval_json(found.ratio);
      } else {
        continue;
      }
      list.push_back(std::move(entry));
    }
    return list;
  }

  const Plan& plan_;
  PlanScene scene_;
  int threads_;
  std::vector<std::vector<MethodResults>> budgets_;  // [budget][method]
  std::vector<std::vector<Condition>> conditions_;   // [budget][metric that is known]
};

// A method's ratio to the baseline over the scenes, and on how many it is better and worse; null
// where a scene does not have both.
ordered_json against_baseline(const std::vector<SceneStudy>& studies, std::size_t budget,
                              std::size_t method, const std::string& metric) {
  std::vector<Interval> ratios;
  int better = 0, worse = 0;
  for (const SceneStudy& study : studies) {
    const Condition* condition = study.condition(budget, metric);
    if (!condition || !condition->baseline || *condition->baseline == method) return nullptr;
    const PairVerdict* pair = condition->ranking.pair(method, *condition->baseline);
    const std::vector<MethodResults>& methods = study.methods(budget);
    ratios.push_back(pair ? ratio_of(*pair, method)
                          : withheld_ratio(methods[method], methods[*condition->baseline], metric));
    if (ratios.back().n == 0) return nullptr;
    const Verdict verdict = condition->ranking.between(method, *condition->baseline);
    better += verdict == Verdict::kBetter;
    worse += verdict == Verdict::kWorse;
  }
  return {{"ratio", interval_json(mean_of_intervals(ratios))},
          {"better", better},
          {"worse", worse},
          {"undecided", static_cast<int>(studies.size()) - better - worse}};
}

// Geometric means over the scenes, which are taken as given, of every method that all of them have.
void add_overall(ordered_json& list, const Plan& plan, const std::vector<SceneStudy>& studies) {
  if (studies.size() < 2) return;
  for (std::size_t b = 0; b < plan.spp.size(); ++b) {
    for (std::size_t m = 0; m < studies.front().methods(b).size(); ++m) {
      ordered_json entry = {{"spp", plan.spp[b]}, {"threads", studies.front().threads()}};
      entry.update(names_of(studies.front().methods(b)[m]));
      for (std::size_t q = 0; q < quantities().size(); ++q) {
        std::vector<Interval> intervals;
        for (const SceneStudy& study : studies)
          intervals.push_back(study.methods(b)[m].interval(q));
        if (!std::ranges::all_of(intervals, &Interval::logarithmic)) continue;
        ordered_json found = interval_json(mean_of_intervals(intervals));
        if (!found.empty()) entry["quantities"][quantities()[q].name] = std::move(found);
      }
      for (const std::string& metric : compared_metrics()) {
        ordered_json found = against_baseline(studies, b, m, metric);
        if (!found.is_null()) entry["against_baseline"][metric] = std::move(found);
      }
      if (entry.contains("quantities")) list.push_back(std::move(entry));
    }
  }
}

}  // namespace

ordered_json statistics_of(const Plan& plan, const ReadRecord& read) {
  ordered_json root = {{"version", 1}};
  for (const auto& [name, text] : kRules)
    root["rules"][name] = text;
  for (const char* list : {"scenes", "claims", "results", "conditions", "curves", "overall"})
    root[list] = ordered_json::array();
  root["baseline"] = plan.baseline.empty()
                         ? fmt::format("{} + {}", kBaselineSampler, kBaselineFilter)
                         : plan.baseline;
  const std::vector<PlanScene> scenes = scenes_of(plan);
  for (const PlanScene& scene : scenes) {
    root["scenes"].push_back({{"dump", scene.recordings.front()},
                              {"group", scene.group},
                              {"recordings", scene.recordings}});
  }
  std::vector<ClaimPlace> places;
  for (const int threads : plan.threads) {
    std::vector<SceneStudy> studies;
    for (const PlanScene& scene : scenes) {
      studies.emplace_back(plan, scene, threads, read);
      studies.back().add_claims(places);
      studies.back().add_results(root["results"]);
      studies.back().add_conditions(root["conditions"]);
      studies.back().add_curves(root["curves"]);
    }
    add_overall(root["overall"], plan, studies);
  }
  root["claims"] = claims_json(plan, places);
  return root;
}

std::string statistics_text(const ordered_json& statistics) {
  return statistics.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace spool::tools
