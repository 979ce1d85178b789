#include "tools/compare.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <nlohmann/json.hpp>

#include "lib/evaluation/budget_curve.h"
#include "lib/evaluation/comparison.h"
#include "lib/evaluation/intervals.h"
#include "lib/evaluation/plan.h"
#include "tools/cell_store.h"
#include "tools/dump_identity.h"
#include "tools/external_methods.h"
#include "tools/method_settings.h"

namespace spool::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kCpuTime = "cpu";

// One combination of recording, budget, threads, sampler and filter in one folder.
struct Combination {
  Cell cell;  // of replicate 0
  std::vector<ResultRecord> replicates;
};

struct Folder {
  fs::path path;
  Plan plan;
  std::map<std::string, std::string> sha256;        // by file name of the recording
  std::map<std::string, Combination> combinations;  // by key
};

std::string file_name(const std::string& dump) {
  return fs::path(dump).filename().string();
}

std::string key_of(const Cell& cell) {
  return fmt::format("{}  {} + {}  {:g} spp{}", fs::path(cell.dump).stem().string(),
                     cell.sampler.label(), cell.filter.label(), cell.spp,
                     cell.threads > 0 ? fmt::format("  {} threads", cell.threads) : "");
}

Result<Folder> read_folder(const fs::path& path) {
  Folder folder{path, {}, {}, {}};
  std::error_code status;
  if (!fs::is_regular_file(path / "plan.toml", status)) {
    return fail(ErrorCode::kIo,
                "{}: no plan.toml in it: give a folder that spool evaluate -o wrote",
                path.string());
  }
  SPOOL_ASSIGN(folder.plan, read_plan(path / "plan.toml", {known_samplers(), known_filters(),
                                                           &make_sampler, &make_filter}));
  for (const DumpIdentity& dump : known_dumps(path))
    folder.sha256[dump.path.filename().string()] = dump.sha256;
  const CellStore store(path);
  for (const Cell& cell : folder.plan.cells()) {
    Result<ResultRecord> record = store.read(cell_id(cell, folder.plan), cell);
    if (!record) continue;
    Combination& combination = folder.combinations[key_of(cell)];
    if (combination.replicates.empty()) combination.cell = cell;
    combination.replicates.push_back(std::move(*record));
  }
  if (folder.combinations.empty()) {
    return fail(ErrorCode::kData, "{}: no finished results in it", path.string());
  }
  return folder;
}

// Cases were drawn alike: replicate r of both took the same samples.
bool is_paired(const Folder& a, const Folder& b, const Cell& cell) {
  const std::string name = file_name(cell.dump);
  const auto first = a.sha256.find(name), second = b.sha256.find(name);
  return first != a.sha256.end() && second != b.sha256.end() && first->second == second->second &&
         a.plan.experiment.seed == b.plan.experiment.seed &&
         a.plan.experiment.order == b.plan.experiment.order;
}

MethodSeries series_of(const Combination& combination, const std::string& metric) {
  std::vector<const ResultRecord*> records;
  for (const ResultRecord& record : combination.replicates)
    records.push_back(&record);
  if (metric != kCpuTime) return record_series("", metric, records);
  MethodSeries series;
  for (const ResultRecord* record : records)
    series.values.push_back(record->number("cpu_sampling") + record->number("cpu_filtering"));
  return series;
}

double mean_of(const MethodSeries& series) {
  double sum = 0.0;
  int n = 0;
  for (const double value : series.values) {
    if (!std::isfinite(value)) continue;
    sum += value;
    ++n;
  }
  return n > 0 ? sum / n : std::nan("");
}

PairedComparison compare_independent(const MethodSeries& a, const MethodSeries& b) {
  const ResampledMean first = resampled_mean(a, 1), second = resampled_mean(b, 2);
  PairedComparison c;
  c.difference = first.mean - second.mean;
  c.standard_error = std::hypot(first.standard_error, second.standard_error);
  const double freedom = std::min({first.freedom, second.freedom, 1e6});
  const double reach = student_quantile(0.975, freedom) * c.standard_error;
  c.low = c.difference - reach;
  c.high = c.difference + reach;
  if (std::isfinite(c.difference) && c.difference != 0.0 && !std::isnan(c.standard_error)) {
    c.p = 2.0 * student_cdf(-std::abs(c.difference) / c.standard_error, freedom);
  }
  return c;
}

// Of times: few values, each from a machine that does other things too [Welch47], with the smaller
// number of degrees of freedom.
PairedComparison compare_times(const MethodSeries& a, const MethodSeries& b) {
  const Interval first = mean_interval(a.values), second = mean_interval(b.values);
  PairedComparison c;
  c.difference = first.mean - second.mean;
  c.standard_error = std::hypot(first.standard_error, second.standard_error);
  const int freedom = std::min(first.n, second.n) - 1;
  c.low = c.high = std::nan("");
  if (freedom < 1 || !(c.standard_error > 0.0)) return c;
  const double reach = student_quantile(0.975, freedom) * c.standard_error;
  c.low = c.difference - reach;
  c.high = c.difference + reach;
  c.p = 2.0 * (1.0 - student_cdf(std::abs(c.difference) / c.standard_error, freedom));
  return c;
}

struct Change {
  std::string key, metric;
  double before = 0, after = 0;
  PairedComparison difference;  // after less before
  double p = 1;                 // adjusted
  bool paired = false, biased = false;
  std::string verdict;  // identical, same, better, worse
};

Change compare_one(const Folder& a, const Folder& b, const Combination& before,
                   const Combination& after, const std::string& metric) {
  MethodSeries first = series_of(before, metric), second = series_of(after, metric);
  Change change{
      key_of(before.cell), metric, mean_of(first), mean_of(second), {}, 1, false, false, "same"};
  change.paired = metric != kCpuTime && is_paired(a, b, before.cell) &&
                  first.values.size() == second.values.size();
  if (metric == kCpuTime) {
    change.difference = compare_times(second, first);
  } else {
    change.difference =
        change.paired ? compare_paired(second, first) : compare_independent(second, first);
  }
  change.biased = after.replicates.front().text("reference").ends_with("(biased)");
  if (first.values == second.values) change.verdict = "identical";
  return change;
}

// Distance from the best value: what may grow no further.
double cost(double value, const std::string& metric) {
  if (metric == kCpuTime) return value;
  const Better better = metrics()[static_cast<std::size_t>(metric_index(metric))].better;
  if (better == Better::kHigher) return -value;
  return better == Better::kOne ? std::abs(value - 1.0) : value;
}

void judge(std::vector<Change>& changes, const CompareOptions& options) {
  std::vector<double> p;
  for (const Change& change : changes)
    p.push_back(change.difference.p);
  const std::vector<double> adjusted = holm_adjusted(p);
  for (std::size_t i = 0; i < changes.size(); ++i) {
    Change& change = changes[i];
    change.p = adjusted[i];
    if (change.verdict == "identical" || !(adjusted[i] < options.significance)) continue;
    const double before = cost(change.before, change.metric);
    const double after = cost(change.after, change.metric);
    if (std::abs(after - before) <= options.tolerance * std::abs(before)) continue;
    change.verdict = after > before ? "worse" : "better";
  }
}

bool has_failed(const Combination& combination) {
  return std::ranges::any_of(combination.replicates,
                             [](const ResultRecord& record) { return record.failed(); });
}

std::string shown(double value) {
  return std::isfinite(value) ? fmt::format("{:.4g}", value) : "n/a";
}

ordered_json number(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

struct Outcome {
  std::vector<Change> changes;
  std::vector<std::string> only_before, only_after, newly_failed;
};

std::string text_of(const Outcome& outcome, bool all) {
  std::vector<std::vector<std::string>> rows = {
      {"", "metric", "before", "after", "ratio", "difference (95 %)", "p (Holm)", "verdict"}};
  std::map<std::string, int> count;
  bool biased = false;
  for (const Change& c : outcome.changes) {
    ++count[c.verdict];
    biased = biased || c.biased;
    if (!all && c.verdict != "better" && c.verdict != "worse") continue;
    rows.push_back({c.key, c.metric, shown(c.before), shown(c.after), shown(c.after / c.before),
                    fmt::format("{} [{}, {}]", shown(c.difference.difference),
                                shown(c.difference.low), shown(c.difference.high)),
                    fmt::format("{:.2g}", c.p), c.verdict});
  }
  std::string text = rows.size() > 1 ? format_columns(rows, 2) + "\n" : "";
  const auto list = [&](const char* what, const std::vector<std::string>& keys) {
    for (const std::string& key : keys)
      text += fmt::format("{}: {}\n", what, key);
  };
  list("failed now", outcome.newly_failed);
  list("only before", outcome.only_before);
  list("only after", outcome.only_after);
  const bool paired = std::ranges::any_of(outcome.changes, &Change::paired);
  text += fmt::format(
      "{} comparisons ({}): {} better, {} worse, {} not told apart, {} identical.\n",
      outcome.changes.size(), paired ? "paired by replicate and pixel block" : "independent",
      count["better"], count["worse"], count["same"], count["identical"]);
  if (biased) text += "BIASED: judged by the samples that images were made of.\n";
  return text;
}

std::string json_of(const Outcome& outcome) {
  ordered_json list = ordered_json::array();
  for (const Change& c : outcome.changes) {
    list.push_back({{"combination", c.key},
                    {"metric", c.metric},
                    {"before", number(c.before)},
                    {"after", number(c.after)},
                    {"difference", number(c.difference.difference)},
                    {"low", number(c.difference.low)},
                    {"high", number(c.difference.high)},
                    {"p_holm", c.p},
                    {"paired", c.paired},
                    {"biased", c.biased},
                    {"verdict", c.verdict}});
  }
  const ordered_json root = {{"comparisons", list},
                             {"newly_failed", outcome.newly_failed},
                             {"only_before", outcome.only_before},
                             {"only_after", outcome.only_after}};
  return root.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

Result<std::vector<std::string>> chosen_metrics(const CompareOptions& options) {
  std::vector<std::string> known = compared_metrics();
  known.emplace_back(kCpuTime);
  std::vector<std::string> chosen = split_list(options.metrics);
  for (const std::string& metric : chosen) {
    if (std::ranges::find(known, metric) != known.end()) continue;
    const std::string near = nearest_name(metric, known);
    return fail(ErrorCode::kUsage, "--metric {}: cannot be compared{}: one of {}", metric,
                near.empty() ? "" : fmt::format(", did you mean '{}'?", near),
                fmt::join(known, ", "));
  }
  if (chosen.empty()) return fail(ErrorCode::kUsage, "--metric: name at least one");
  return chosen;
}

}  // namespace

Result<void> run_compare(const CompareOptions& options, const CommonOptions& common) {
  SPOOL_ASSIGN(const std::vector<std::string> metrics, chosen_metrics(options));
  SPOOL_ASSIGN(const Folder before, read_folder(options.before));
  SPOOL_ASSIGN(const Folder after, read_folder(options.after));
  Outcome outcome;
  for (const auto& [key, combination] : before.combinations) {
    const auto found = after.combinations.find(key);
    if (found == after.combinations.end()) {
      outcome.only_before.push_back(key);
      continue;
    }
    if (has_failed(found->second) && !has_failed(combination)) outcome.newly_failed.push_back(key);
    for (const std::string& metric : metrics)
      outcome.changes.push_back(compare_one(before, after, combination, found->second, metric));
  }
  for (const auto& [key, combination] : after.combinations) {
    if (!before.combinations.contains(key)) outcome.only_after.push_back(key);
  }
  if (outcome.changes.empty()) {
    return fail(ErrorCode::kData, "{} and {}: have no result in common", options.before.string(),
                options.after.string());
  }
  judge(outcome.changes, options);
  print(common.json ? json_of(outcome) : text_of(outcome, options.all));
  const auto worse = std::ranges::count(outcome.changes, "worse", &Change::verdict);
  if (worse == 0 && outcome.newly_failed.empty() && outcome.only_before.empty()) return {};
  return fail(ErrorCode::kData, "{}: {} worse, {} failed, {} missing against {}",
              options.after.string(), worse, outcome.newly_failed.size(),
              outcome.only_before.size(), options.before.string());
}

}  // namespace spool::tools
