#include "tools/evaluation_summary.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>

#include <nlohmann/json.hpp>

#include "lib/evaluation/intervals.h"
#include "tools/console.h"

namespace spool::tools {
namespace {

// The replicates of one recording, budget, sampler and filter.
struct Group {
  const CellResult* first = nullptr;
  std::vector<double> mse, relmse, energy, sampling, filtering, spent;

  bool same_conditions(const Cell& cell) const {
    return first->cell.dump == cell.dump && first->cell.spp == cell.spp;
  }
  bool holds(const Cell& cell) const {
    return same_conditions(cell) && first->cell.sampler == cell.sampler &&
           first->cell.filter == cell.filter;
  }
};

// By recording and budget, each in the order in which it was run.
std::vector<Group> group_results(const std::vector<CellResult>& results) {
  std::vector<Group> groups;
  for (const CellResult& result : results) {
    if (result.error) continue;
    Group* group = nullptr;
    for (Group& candidate : groups) {
      if (candidate.holds(result.cell)) group = &candidate;
    }
    if (!group) {
      groups.emplace_back();
      group = &groups.back();
      group->first = &result;
    }
    group->mse.push_back(result.metrics["mse"].value);
    group->relmse.push_back(result.metrics["relmse"].value);
    group->energy.push_back(result.metrics["energy_ratio"].value);
    group->sampling.push_back(result.sampling.wall);
    group->filtering.push_back(result.filtering.wall);
    group->spent.push_back(static_cast<double>(result.log.spent) /
                           (static_cast<double>(result.width) * result.height));
  }
  std::vector<Group> sorted;
  for (const Group& group : groups) {
    const auto same = [&](const Group& other) { return other.same_conditions(group.first->cell); };
    if (std::ranges::any_of(sorted, same)) continue;
    std::ranges::copy_if(groups, std::back_inserter(sorted), same);
  }
  return sorted;
}

const Group* baseline_of(const std::vector<Group>& groups, const Group& group) {
  for (const Group& candidate : groups) {
    const Cell& cell = candidate.first->cell;
    if (candidate.same_conditions(group.first->cell) && cell.sampler.name == "uniform" &&
        cell.filter.name == "box") {
      return &candidate;
    }
  }
  return nullptr;
}

double ratio(const std::vector<double>& values, const std::vector<double>& baseline) {
  return mean_interval(values).mean / mean_interval(baseline).mean;
}

std::string with_error(const std::vector<double>& values) {
  const Interval interval = mean_interval(values);
  if (!std::isfinite(interval.mean)) return "n/a";
  if (!std::isfinite(interval.standard_error)) return fmt::format("{:.4g}", interval.mean);
  return fmt::format("{:.4g} +- {:.2g}", interval.mean, interval.standard_error);
}

std::string factor(double value) {
  return std::isfinite(value) ? fmt::format("{:.3f}", value) : "-";
}

nlohmann::ordered_json json_of(const std::vector<double>& values) {
  const Interval interval = mean_interval(values);
  return {{"mean", interval.mean},
          {"standard_error", interval.standard_error},
          {"low", interval.low},
          {"high", interval.high}};
}

}  // namespace

std::string summary_text(const std::vector<CellResult>& results) {
  const std::vector<Group> groups = group_results(results);
  std::vector<std::vector<std::string>> rows = {{"dump", "sampler", "filter", "spp", "spent", "MSE",
                                                 "x uniform+box", "relMSE", "x uniform+box",
                                                 "energy", "sampling", "filtering"}};
  bool biased = false;
  for (const Group& group : groups) {
    const Cell& cell = group.first->cell;
    const Group* baseline = baseline_of(groups, group);
    biased = biased || is_biased(group.first->reference);
    rows.push_back({std::filesystem::path(cell.dump).stem().string(), cell.sampler.label(),
                    cell.filter.label(), fmt::format("{:g}", cell.spp),
                    fmt::format("{:.4g}", mean_interval(group.spent).mean), with_error(group.mse),
                    baseline ? factor(ratio(group.mse, baseline->mse)) : "-",
                    with_error(group.relmse),
                    baseline ? factor(ratio(group.relmse, baseline->relmse)) : "-",
                    fmt::format("{:.3f}", mean_interval(group.energy).mean),
                    format_seconds(mean_interval(group.sampling).mean),
                    format_seconds(mean_interval(group.filtering).mean)});
  }
  if (groups.empty()) return "no results\n";
  std::string text = format_columns(rows, 3);
  text += fmt::format("\nMean +- standard error over {} replicates; judged by: {}{}.\n",
                      groups.front().mse.size(), reference_name(groups.front().first->reference),
                      biased ? " (BIASED: see spool evaluate --help)" : "");
  return text;
}

std::string summary_json(const std::vector<CellResult>& results) {
  const std::vector<Group> groups = group_results(results);
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Group& group : groups) {
    const Cell& cell = group.first->cell;
    nlohmann::ordered_json entry = {
        {"dump", cell.dump},
        {"sampler", cell.sampler.label()},
        {"filter", cell.filter.label()},
        {"spp", cell.spp},
        {"replicates", group.mse.size()},
        {"reference", std::string(reference_name(group.first->reference))},
        {"spent_per_pixel", mean_interval(group.spent).mean},
        {"mse", json_of(group.mse)},
        {"relmse", json_of(group.relmse)},
        {"energy_ratio", json_of(group.energy)},
        {"seconds_sampling", json_of(group.sampling)},
        {"seconds_filtering", json_of(group.filtering)}};
    if (const Group* baseline = baseline_of(groups, group)) {
      entry["mse_to_uniform_box"] = ratio(group.mse, baseline->mse);
      entry["relmse_to_uniform_box"] = ratio(group.relmse, baseline->relmse);
    }
    list.push_back(entry);
  }
  return list.dump(2) + "\n";
}

}  // namespace spool::tools
