#include "lib/study/condition.h"

#include <algorithm>
#include <utility>

namespace spool {
namespace {

constexpr double kEnergyLoss = 0.02;

bool has_pairs(const std::string& metric) {
  return metric == "relmse" || metric == "mse";
}

// Methods outside the plan's energy band are listed and not compared.
std::vector<bool> outside_band(const Plan& plan, const std::vector<MethodResults>& methods) {
  std::vector<bool> outside;
  if (!plan.energy_band) return outside;
  const auto& [low, high] = *plan.energy_band;
  for (const MethodResults& method : methods) {
    const double energy = method.interval(quantity_index("energy_ratio")).mean;
    outside.push_back(!(energy >= low && energy <= high));
  }
  return outside;
}

About about(const Plan& plan, const PlanScene& scene, const std::vector<MethodResults>& methods) {
  double shared = 0.0;
  bool known = true, one_image = true, measured = true;
  std::size_t given = scene.recordings.size();  // with results
  for (const MethodResults& method : methods) {
    if (method.done == 0) continue;
    shared = std::max(shared, method.shared);
    given = std::min(given, method.with_results.size());
    known = known && method.shared_known;
    measured = measured && (!method.spread.empty() || method.one_image());
    one_image = one_image && method.one_image();
  }
  // Of older programs, with halves = false, and where a half is shorter than the budget.
  const char* assumed = measured ? ""
                                 : "; how much recordings differ is assumed from common samples "
                                   "and not measured on halves";
  const auto said = [&](const char* kind, std::string text) {
    return About{kind, shared, std::move(text)};
  };
  if (one_image) {
    return said(
        "one image",
        "these images: one replicate, or replicates that are one image; intervals from blocks of "
        "pixels, nothing is compared");
  }
  if (given > 1) {
    const bool own = given >= static_cast<std::size_t>(kOwnSpread);
    return said("recordings",
                fmt::format("another recording of the scene, of which {} were given{}", given,
                            own ? ": intervals are of the spread between these" : ""));
  }
  if (!known) {
    return said("order",
                "this recording in another order of its samples: how many it has is not known");
  }
  if (shared > 0.0) {
    return said("shared",
                fmt::format("another recording of the scene; replicates of one method share up to "
                            "{:g} % of their samples{}, and intervals are widened for it{}",
                            std::stod(fmt::format("{:.2g}", 100.0 * shared)),
                            plan.experiment.order == ReplicateOrder::kShuffled
                                ? " (each shuffles the same ones)"
                                : "",
                            assumed));
  }
  return said("disjoint",
              fmt::format("another recording of the scene; replicates have no sample in common{}",
                          assumed));
}

struct Places {
  const std::vector<RankedMethod>& ranked;

  std::size_t of(std::size_t method) const {
    return static_cast<std::size_t>(std::ranges::find(ranked, method, &RankedMethod::method) -
                                    ranked.begin());
  }
};

std::vector<PairFinding> pairs_of(const Condition& condition) {
  const Places places{condition.ranking.methods};
  std::vector<PairFinding> list;
  for (const PairVerdict& pair : condition.ranking.pairs)
    list.push_back({places.of(pair.a), places.of(pair.b), pair.ratio, pair.p, pair.verdict});
  return list;
}

std::optional<WouldDecide> would_decide(const PairVerdict& pair, const MethodResults& method,
                                        double spp) {
  constexpr double kMost = 10000.0;
  // The level that the family leaves to this pair.
  const MoreNeeded more = more_needed(pair.comparison, method.given(), 0.05 / pair.factor);
  const double reach = method.given() * method.taken.recorded / spp;
  if (more.replicates <= std::min(kMost, reach)) return WouldDecide{more.replicates, false};
  if (more.recordings <= kMost) return WouldDecide{more.recordings, true};
  return std::nullopt;
}

void add_against_baseline(RankedFinding& finding, const Plan& plan,
                          const std::vector<MethodResults>& methods, const Condition& condition,
                          std::size_t method) {
  const Verdict verdict = condition.ranking.between(method, *condition.baseline);
  finding.against_baseline = verdict;
  const PairVerdict* pair = condition.ranking.pair(method, *condition.baseline);
  if (const Interval ratio = baseline_ratio(condition, methods, method); pair || ratio.n > 0)
    finding.ratio = ratio;
  if (!pair && finding.ratio)
    finding.baseline_withheld = methods[*condition.baseline].withheld(condition.metric);
  if (pair && verdict == Verdict::kUndecided && plan.replicates > 1)
    finding.would_decide = would_decide(*pair, methods[method], condition.spp);
}

RankedFinding ranked_finding(const Plan& plan, const std::vector<MethodResults>& methods,
                             const Condition& condition, const RankedMethod& ranked) {
  const MethodResults& method = methods[ranked.method];
  RankedFinding finding;
  const std::size_t quantity = quantity_index(condition.metric);
  finding.value = method.interval(quantity);
  if (plan.experiment.order == ReplicateOrder::kShuffled && !method.one_image())
    finding.order = mean_interval({method.values[quantity], 0.0}, Range::kPositive);
  finding.letters = ranked.letters;
  finding.compared = ranked.compared;
  finding.withheld = method.withheld(condition.metric);
  const std::size_t best = condition.ranking.methods.front().method;
  if (ranked.compared && ranked.method != best) {
    finding.against_best = condition.ranking.between(ranked.method, best);
    if (const PairVerdict* pair = condition.ranking.pair(ranked.method, best))
      finding.p_against_best = pair->p;
  }
  if (condition.baseline && ranked.method != *condition.baseline)
    add_against_baseline(finding, plan, methods, condition, ranked.method);
  finding.energy = method.interval(quantity_index("energy_ratio"));
  if (finding.energy.high < 1.0 - kEnergyLoss) finding.loses_energy = 1.0 - finding.energy.mean;
  return finding;
}

// Of `method` to the other of the pair; nothing where errors were not compared by logarithms.
Interval ratio_of(const PairVerdict& pair, std::size_t method) {
  Interval ratio = pair.ratio;
  if (pair.a == method) return ratio;
  ratio.mean = 1.0 / ratio.mean;
  std::swap(ratio.low, ratio.high);
  ratio.low = 1.0 / ratio.low;
  ratio.high = 1.0 / ratio.high;
  return ratio;
}

// Of two methods of which one has its verdict withheld: the ratio without an interval; else
// nothing.
Interval withheld_ratio(const MethodResults& method, const MethodResults& other,
                        const std::string& metric) {
  if (method.withheld(metric) == Withheld::kNo && other.withheld(metric) == Withheld::kNo)
    return {};
  const std::size_t quantity = quantity_index(metric);
  return compare_paired(method.series(quantity), other.series(quantity), better_of(metric)).ratio();
}

}  // namespace

Interval baseline_ratio(const Condition& condition, const std::vector<MethodResults>& methods,
                        std::size_t method) {
  const PairVerdict* pair = condition.ranking.pair(method, *condition.baseline);
  return pair ? ratio_of(*pair, method)
              : withheld_ratio(methods[method], methods[*condition.baseline], condition.metric);
}

namespace {

std::string asked_baseline(const Plan& plan) {
  return plan.baseline.empty() ? std::string(kBaseline) : plan.baseline;
}

}  // namespace

std::optional<std::size_t> baseline_of(const Plan& plan) {
  const std::string asked = asked_baseline(plan);
  std::vector<std::size_t> bare;
  for (std::size_t s = 0; s < plan.samplers.size(); ++s) {
    for (std::size_t f = 0; f < plan.filters.size(); ++f) {
      const MethodChoice &sampler = plan.samplers[s], &filter = plan.filters[f];
      const std::size_t method = s * plan.filters.size() + f;
      if (sampler.label() + " + " + filter.label() == asked) return method;
      if (sampler.name + " + " + filter.name == asked) bare.push_back(method);
    }
  }
  return bare.size() == 1 ? std::optional(bare.front()) : std::nullopt;
}

std::string baseline_name(const Plan& plan) {
  const std::optional<std::size_t> method = baseline_of(plan);
  if (!method) return asked_baseline(plan);
  return plan.samplers[*method / plan.filters.size()].label() + " + " +
         plan.filters[*method % plan.filters.size()].label();
}

std::optional<Condition> rank_condition(const Plan& plan, const std::vector<MethodResults>& methods,
                                        const std::string& metric, double spp) {
  const std::size_t quantity = quantity_index(metric);
  std::vector<Series> series;
  std::vector<bool> outside = outside_band(plan, methods);
  bool any = false;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    series.push_back(methods[m].series(quantity));
    any = any || series.back().known() > 0;
    if (methods[m].one_image()) {
      outside.resize(methods.size(), false);
      outside[m] = true;
    }
  }
  if (!any) return std::nullopt;
  RankOptions options;
  options.range = quantities()[quantity].range;
  options.baseline = baseline_of(plan);
  options.left_out = std::move(outside);
  return Condition{metric, spp, rank_methods(series, better_of(metric), options), options.baseline};
}

ConditionFinding condition_finding(const Plan& plan, const PlanScene& scene,
                                   const std::vector<MethodResults>& methods,
                                   const std::vector<std::size_t>& results,
                                   const Condition& condition) {
  ConditionFinding found;
  found.metric = condition.metric;
  found.biased = std::ranges::any_of(methods, &MethodResults::biased);
  found.about = about(plan, scene, methods);
  for (const RankedMethod& ranked : condition.ranking.methods) {
    if (methods[ranked.method].done == 0) continue;
    found.ranking.push_back(ranked_finding(plan, methods, condition, ranked));
    found.ranking.back().result = results[ranked.method];
  }
  if (has_pairs(condition.metric)) found.pairs = pairs_of(condition);
  return found;
}

}  // namespace spool
