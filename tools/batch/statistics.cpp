#include "tools/batch/statistics.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <nlohmann/json.hpp>

#include "lib/experiment/baseline.h"
#include "lib/inference/budget_curve.h"
#include "lib/inference/comparison.h"
#include "lib/inference/intervals.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

// Pairs grow with the square of the methods: beyond this, only those with the best are compared.
constexpr std::size_t kAllPairs = 24;
const std::vector<std::string> kPairedMetrics = {"relmse", "mse"};

// NaN and infinity have no place in JSON.
ordered_json number(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

struct Method {
  std::size_t sampler = 0, filter = 0;
};

// What is kept of a record while methods are compared.
struct Slim {
  int blocks = 0;
  std::vector<double> values;                  // [compared metric]
  std::vector<std::vector<float>> deviations;  // [compared metric][resample]
};
using Replicates = std::vector<std::optional<Slim>>;

// All results of one recording and number of threads, read as they are needed.
class RecordingStudy {
 public:
  RecordingStudy(const Plan& plan, std::string dump, int threads,
                 const std::function<Result<ResultRecord>(const Cell&)>& record)
      : plan_(plan), dump_(std::move(dump)), threads_(threads), record_(record) {
    for (std::size_t s = 0; s < plan.samplers.size(); ++s) {
      for (std::size_t f = 0; f < plan.filters.size(); ++f)
        methods_.push_back({s, f});
    }
  }

  void add_conditions(ordered_json& list) {
    for (std::size_t b = 0; b < plan_.spp.size(); ++b) {
      std::vector<Replicates> records;
      for (std::size_t m = 0; m < methods_.size(); ++m)
        records.push_back(read(b, m));
      for (const std::string& metric : compared_metrics()) {
        ordered_json entry = condition(b, metric, records);
        if (!entry.is_null()) list.push_back(std::move(entry));
      }
    }
  }

  void add_curves(ordered_json& list) {
    if (plan_.spp.size() < 2) return;
    const auto against = baseline();
    const std::vector<Replicates> targets =
        against ? read_budgets(*against) : std::vector<Replicates>();
    for (std::size_t m = 0; m < methods_.size(); ++m) {
      const std::vector<Replicates> records = read_budgets(m);
      for (const std::string& metric : kPairedMetrics) {
        const BudgetCurve curve = curve_of(records, m, metric);
        if (curve.spp.size() < 2) continue;
        const ErrorSlope slope = error_slope(curve);
        ordered_json entry = describe(m);
        entry["metric"] = metric;
        entry["budgets"] = curve.spp;
        entry["slope"] = number(slope.fit.slope);
        entry["slope_low"] = number(slope.low);
        entry["slope_high"] = number(slope.high);
        if (against && *against != m) {
          entry["samples_for_the_error_of_uniform_box"] = needed(curve, targets, metric);
        }
        list.push_back(std::move(entry));
      }
    }
  }

 private:
  Replicates read(std::size_t budget, std::size_t m) {
    Replicates replicates;
    for (int r = 0; r < plan_.replicates; ++r) {
      Result<ResultRecord> found =
          record_({dump_, plan_.samplers[methods_[m].sampler], plan_.filters[methods_[m].filter],
                   plan_.spp[budget], r, threads_});
      std::optional<Slim>& slim = replicates.emplace_back();
      if (!found || found->failed()) continue;
      slim.emplace().blocks = found->blocks();
      for (const std::string& metric : compared_metrics())
        slim->values.push_back(found->number(metric));
      slim->deviations = std::move(found->deviations);
      biased_ = biased_ || found->text("reference").ends_with("(biased)");
    }
    return replicates;
  }

  std::vector<Replicates> read_budgets(std::size_t m) {
    std::vector<Replicates> budgets;
    for (std::size_t b = 0; b < plan_.spp.size(); ++b)
      budgets.push_back(read(b, m));
    return budgets;
  }

  std::string name_of(std::size_t m) const {
    return plan_.samplers[methods_[m].sampler].label() + " + " +
           plan_.filters[methods_[m].filter].label();
  }

  ordered_json describe(std::size_t m) const {
    return {{"dump", dump_},
            {"threads", threads_},
            {"biased", biased_},
            {"sampler", plan_.samplers[methods_[m].sampler].label()},
            {"filter", plan_.filters[methods_[m].filter].label()}};
  }

  MethodSeries series(const Replicates& replicates, std::size_t m,
                      const std::string& metric) const {
    const auto index = static_cast<std::size_t>(std::ranges::find(compared_metrics(), metric) -
                                                compared_metrics().begin());
    MethodSeries result{name_of(m), {}, {}};
    for (const std::optional<Slim>& one : replicates) {
      const double value = one ? one->values[index] : std::nan("");
      result.values.push_back(value);
      std::vector<double>& resampled = result.resampled.emplace_back();
      if (one) result.blocks = one->blocks;
      if (!one || index >= one->deviations.size()) continue;
      for (const float deviation : one->deviations[index])
        resampled.push_back(value + static_cast<double>(deviation));
    }
    return result;
  }

  static bool is_known(const MethodSeries& series) {
    return std::ranges::any_of(series.values, [](double v) { return std::isfinite(v); });
  }

  std::optional<std::size_t> baseline() const {
    for (std::size_t m = 0; m < methods_.size(); ++m) {
      if (is_baseline(plan_.samplers[methods_[m].sampler], plan_.filters[methods_[m].filter]))
        return m;
    }
    return std::nullopt;
  }

  BudgetCurve curve_of(const std::vector<Replicates>& records, std::size_t m,
                       const std::string& metric) const {
    std::vector<std::size_t> order;
    for (std::size_t b = 0; b < plan_.spp.size(); ++b)
      order.push_back(b);
    std::ranges::sort(order, {}, [&](std::size_t b) { return plan_.spp[b]; });
    BudgetCurve curve;
    for (const std::size_t b : order) {
      MethodSeries at = series(records[b], m, metric);
      if (!is_known(at)) continue;
      curve.spp.push_back(plan_.spp[b]);
      curve.series.push_back(std::move(at));
    }
    return curve;
  }

  ordered_json needed(const BudgetCurve& curve, const std::vector<Replicates>& targets,
                      const std::string& metric) const {
    ordered_json list = ordered_json::array();
    for (std::size_t b = 0; b < plan_.spp.size(); ++b) {
      const MethodSeries target = series(targets[b], 0, metric);
      if (!is_known(target)) continue;
      const SamplesNeeded found = samples_needed(curve, target);
      list.push_back({{"at", plan_.spp[b]},
                      {"spp", number(found.spp)},
                      {"low", number(found.low)},
                      {"high", number(found.high)},
                      {"bound", found.at_most ? "at most" : (found.more_than ? "more than" : "")}});
    }
    return list;
  }

  ordered_json condition(std::size_t budget, const std::string& metric,
                         const std::vector<Replicates>& records) const {
    std::vector<MethodSeries> known;
    std::vector<std::size_t> index;
    for (std::size_t m = 0; m < methods_.size(); ++m) {
      MethodSeries one = series(records[m], m, metric);
      if (!is_known(one)) continue;
      known.push_back(std::move(one));
      index.push_back(m);
    }
    if (known.empty()) return nullptr;
    ordered_json entry = {{"dump", dump_},       {"spp", plan_.spp[budget]},
                          {"threads", threads_}, {"metric", metric},
                          {"biased", biased_},   {"replicates", plan_.replicates}};
    const Better better = metrics()[static_cast<std::size_t>(metric_index(metric))].better;
    const std::vector<RankedMethod> ranked = rank(known, better);
    for (const RankedMethod& method : ranked) {
      const Interval interval = mean_interval(known[method.method].values);
      const Method& names = methods_[index[method.method]];
      entry["ranking"].push_back({{"sampler", plan_.samplers[names.sampler].label()},
                                  {"filter", plan_.filters[names.filter].label()},
                                  {"mean", number(method.mean)},
                                  {"low", number(interval.low)},
                                  {"high", number(interval.high)},
                                  {"rank", method.rank},
                                  {"tie", ties_with(ranked, method)},
                                  {"p_against_best", method.p_against_best}});
    }
    if (std::ranges::find(kPairedMetrics, metric) == kPairedMetrics.end()) return entry;
    entry["pairs"] = pairs(known, ranked);
    return entry;
  }

  // rank_methods compares all pairs; with too many methods, those with the best only.
  static std::vector<RankedMethod> rank(const std::vector<MethodSeries>& methods, Better better) {
    if (methods.size() <= kAllPairs) return rank_methods(methods, better);
    return rank_against_best(methods, better);
  }

  static int ties_with(const std::vector<RankedMethod>& ranked, const RankedMethod& method) {
    return static_cast<int>(std::ranges::count(ranked, method.rank, &RankedMethod::rank)) - 1;
  }

  static ordered_json pairs(const std::vector<MethodSeries>& methods,
                            const std::vector<RankedMethod>& ranked) {
    std::vector<std::pair<const MethodSeries*, const MethodSeries*>> wanted;
    const std::size_t rows = methods.size() <= kAllPairs ? ranked.size() : 1;
    for (std::size_t i = 0; i < rows; ++i) {
      for (std::size_t j = i + 1; j < ranked.size(); ++j)
        wanted.emplace_back(&methods[ranked[i].method], &methods[ranked[j].method]);
    }
    std::vector<PairedComparison> compared;
    std::vector<double> p;
    for (const auto& [a, b] : wanted) {
      compared.push_back(compare_paired(*a, *b));
      p.push_back(compared.back().p);
    }
    const std::vector<double> adjusted = holm_adjusted(p);
    ordered_json list = ordered_json::array();
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      list.push_back({{"a", wanted[i].first->name},
                      {"b", wanted[i].second->name},
                      {"difference", number(compared[i].difference)},
                      {"low", number(compared[i].low)},
                      {"high", number(compared[i].high)},
                      {"p", p[i]},
                      {"p_holm", adjusted[i]}});
    }
    return list;
  }

  const Plan& plan_;
  std::string dump_;
  int threads_;
  const std::function<Result<ResultRecord>(const Cell&)>& record_;
  bool biased_ = false;  // of what was read so far
  std::vector<Method> methods_;
};

}  // namespace

std::string statistics_json(const Plan& plan,
                            const std::function<Result<ResultRecord>(const Cell&)>& record) {
  ordered_json conditions = ordered_json::array(), curves = ordered_json::array();
  for (const std::string& dump : plan.recordings) {
    for (const int threads : plan.threads) {
      RecordingStudy study(plan, dump, threads, record);
      study.add_conditions(conditions);
      study.add_curves(curves);
    }
  }
  const ordered_json root = {
      {"about",
       "95 % intervals by a bootstrap over replicates and 16 x 16 pixel blocks; methods share "
       "rank where no difference is significant at 5 % after Holm's correction"},
      {"conditions", conditions},
      {"curves", curves}};
  return root.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace spool::tools
