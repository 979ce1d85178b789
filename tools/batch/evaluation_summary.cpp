#include "tools/batch/evaluation_summary.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include <nlohmann/json.hpp>

#include "lib/experiment/baseline.h"
#include "lib/experiment/reference.h"
#include "lib/inference/intervals.h"
#include "tools/console.h"
#include "tools/methods/external_methods.h"

namespace spool::tools {
namespace {

constexpr std::size_t kLongestTable = 200;  // lines; beyond, the best of each condition
constexpr std::size_t kBestShown = 5;

double mean_of(const std::vector<double>& values) {
  return mean_interval(values).mean;
}

double ratio(const std::vector<double>& values, const std::vector<double>& baseline) {
  return mean_of(values) / mean_of(baseline);
}

bool is_made_elsewhere(const MethodChoice& filter) {
  const Filter* method = find_method(known_filters(), filter.name);
  return method != nullptr && !method->needs.samples;
}

// Replicates of one image (made elsewhere, or of samples in recorded order) do not say how exact
// their mean is. Errors of one image differ by the samples held out to judge it.
bool replicates_are_alike(const std::vector<double>& errors, const Cell& cell) {
  return errors.size() > 1 &&
         (is_made_elsewhere(cell.filter) ||
          std::ranges::all_of(errors, [&](double error) { return error == errors[0]; }));
}

std::string with_error(const std::vector<double>& values, bool alike) {
  const Interval interval = mean_interval(values);
  if (!std::isfinite(interval.mean)) return "n/a";
  if (!std::isfinite(interval.standard_error)) return fmt::format("{:.4g}", interval.mean);
  if (alike) return fmt::format("{:.4g} (alike)", interval.mean);
  return fmt::format("{:.4g} +- {:.2g}", interval.mean, interval.standard_error);
}

std::string factor(double value) {
  return std::isfinite(value) ? fmt::format("{:.3f}", value) : "-";
}

nlohmann::ordered_json json_of(const std::vector<double>& values, bool alike = false) {
  const Interval interval = mean_interval(values);
  if (alike) {
    return {
        {"mean", interval.mean}, {"standard_error", nullptr}, {"low", nullptr}, {"high", nullptr}};
  }
  return {{"mean", interval.mean},
          {"standard_error", interval.standard_error},
          {"low", interval.low},
          {"high", interval.high}};
}

bool is_biased_text(const std::string& reference) {
  return reference.ends_with("(biased)");
}

}  // namespace

std::string EvaluationSummary::condition_key(const Cell& cell) {
  return fmt::format("{}\n{}\n{}", cell.dump, cell.spp, cell.threads);
}

void EvaluationSummary::add(const Cell& cell, const ResultRecord& record) {
  const std::string& reference = record.text("reference");
  if (reference.empty()) return;
  const std::string condition = condition_key(cell);
  const std::string key =
      fmt::format("{}\n{}\n{}", condition, cell.sampler.label(), cell.filter.label());
  const auto [place, fresh] = index_.try_emplace(key, groups_.size());
  if (fresh) {
    groups_.push_back({cell, reference, {}, {}, {}, {}, {}, {}});
    conditions_.try_emplace(condition, conditions_.size());
    if (is_baseline(cell.sampler, cell.filter)) {
      baselines_.try_emplace(condition, place->second);
    }
  }
  Group& group = groups_[place->second];
  group.mse.push_back(record.number("mse"));
  group.relmse.push_back(record.number("relmse"));
  group.energy.push_back(record.number("energy_ratio"));
  group.sampling.push_back(record.number("seconds_sampling"));
  group.filtering.push_back(record.number("seconds_filtering"));
  group.spent.push_back(record.number("samples_spent") /
                        (record.number("width") * record.number("height")));
}

std::vector<const EvaluationSummary::Group*> EvaluationSummary::sorted() const {
  std::vector<const Group*> order;
  order.reserve(groups_.size());
  for (const Group& group : groups_)
    order.push_back(&group);
  std::ranges::stable_sort(
      order, {}, [&](const Group* group) { return conditions_.at(condition_key(group->cell)); });
  return order;
}

const EvaluationSummary::Group* EvaluationSummary::baseline_of(const Group& group) const {
  const auto found = baselines_.find(condition_key(group.cell));
  return found == baselines_.end() ? nullptr : &groups_[found->second];
}

std::string EvaluationSummary::text() const {
  if (groups_.empty()) return "no results\n";
  const bool threads = std::ranges::any_of(groups_, [](const Group& g) { return g.cell.threads; });
  std::vector<const Group*> shown = sorted();
  const bool shortened = shown.size() > kLongestTable;
  if (shortened) {
    std::ranges::stable_sort(shown, {}, [&](const Group* group) {
      const double error = mean_of(group->relmse);
      return std::pair(conditions_.at(condition_key(group->cell)),
                       std::isnan(error) ? std::numeric_limits<double>::infinity() : error);
    });
    std::map<std::string, std::size_t> taken;
    std::erase_if(shown, [&](const Group* group) {
      return ++taken[condition_key(group->cell)] > kBestShown;
    });
    if (shown.size() > kLongestTable) shown.resize(kLongestTable);
  }
  std::vector<std::vector<std::string>> rows = {{"dump", "sampler", "filter", "spp", "spent", "MSE",
                                                 "x uniform+box", "relMSE", "x uniform+box",
                                                 "energy", "sampling", "filtering"}};
  if (threads) rows.front().emplace_back("threads");
  bool biased = false, described = false, repeated = false;
  for (const Group* group : shown) {
    const Cell& cell = group->cell;
    const Group* baseline = baseline_of(*group);
    biased = biased || is_biased_text(group->reference);
    const bool alike = replicates_are_alike(group->mse, cell);
    repeated = repeated || alike;
    const bool described_sampler = is_by_description(known_samplers(), cell.sampler.name);
    const bool described_filter = is_by_description(known_filters(), cell.filter.name);
    described = described || described_sampler || described_filter;
    rows.push_back(
        {std::filesystem::path(cell.dump).stem().string(),
         cell.sampler.label() + (described_sampler ? kByDescriptionMark : ""),
         cell.filter.label() + (described_filter ? kByDescriptionMark : ""),
         fmt::format("{:g}", cell.spp), fmt::format("{:.4g}", mean_of(group->spent)),
         with_error(group->mse, alike), baseline ? factor(ratio(group->mse, baseline->mse)) : "-",
         with_error(group->relmse, alike),
         baseline ? factor(ratio(group->relmse, baseline->relmse)) : "-",
         fmt::format("{:.3f}", mean_of(group->energy)), format_seconds(mean_of(group->sampling)),
         format_seconds(mean_of(group->filtering))});
    if (threads) rows.back().push_back(std::to_string(cell.threads));
  }
  std::string text = format_columns(rows, 3);
  if (shortened) {
    text += fmt::format("\nThe {} best by relMSE of each recording and budget, of {} in all.\n",
                        kBestShown, groups_.size());
  }
  if (described) text += fmt::format("\n{}.\n", kByDescription);
  if (repeated) {
    text +=
        "\n(alike): replicates of one image, which do not say how exact this is. An image made "
        "elsewhere is judged beside methods that got the same samples with --recorded-order "
        "--replicates 1; results.csv has the standard errors, estimated from blocks of pixels.\n";
  }
  text += fmt::format("\nMean +- standard error over {} replicates; judged by: {}{}.\n",
                      groups_.front().mse.size(), groups_.front().reference,
                      biased ? " (BIASED: see spool evaluate --help)" : "");
  return text;
}

std::string EvaluationSummary::json() const {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Group* group : sorted()) {
    const Cell& cell = group->cell;
    const bool alike = replicates_are_alike(group->mse, cell);
    nlohmann::ordered_json entry = {
        {"dump", cell.dump},
        {"sampler", cell.sampler.label()},
        {"filter", cell.filter.label()},
        {"sampler_by_description", is_by_description(known_samplers(), cell.sampler.name)},
        {"filter_by_description", is_by_description(known_filters(), cell.filter.name)},
        {"spp", cell.spp},
        {"threads", cell.threads},
        {"replicates", group->mse.size()},
        {"reference", group->reference},
        {"biased", is_biased_text(group->reference)},
        {"spent_per_pixel", mean_of(group->spent)},
        {"mse", json_of(group->mse, alike)},
        {"relmse", json_of(group->relmse, alike)},
        {"energy_ratio", json_of(group->energy, alike)},
        {"seconds_sampling", json_of(group->sampling)},
        {"seconds_filtering", json_of(group->filtering)}};
    if (const Group* baseline = baseline_of(*group)) {
      entry["mse_to_uniform_box"] = ratio(group->mse, baseline->mse);
      entry["relmse_to_uniform_box"] = ratio(group->relmse, baseline->relmse);
    }
    list.push_back(entry);
  }
  return list.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace spool::tools
