#include "tools/batch/result_changes.h"

#include <algorithm>
#include <cmath>

#include "lib/inference/budget_curve.h"
#include "lib/inference/intervals.h"
#include "tools/batch/cell_store.h"
#include "tools/batch/dump_identity.h"
#include "tools/methods/external_methods.h"
#include "tools/methods/method_settings.h"

namespace spool::tools {

namespace fs = std::filesystem;

namespace {

std::string file_name(const std::string& dump) {
  return fs::path(dump).filename().string();
}

std::string key_of(const Cell& cell) {
  return fmt::format("{}  {} + {}  {:g} spp{}", fs::path(cell.dump).stem().string(),
                     cell.sampler.label(), cell.filter.label(), cell.spp,
                     cell.threads > 0 ? fmt::format("  {} threads", cell.threads) : "");
}

// Cases were drawn alike: replicate r of both took the same samples.
bool is_paired(const ResultFolder& a, const ResultFolder& b, const Cell& cell) {
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

// Distance from the best value: what may grow no further.
double cost(double value, const std::string& metric) {
  if (metric == kCpuTime) return value;
  const Better better = metrics()[static_cast<std::size_t>(metric_index(metric))].better;
  if (better == Better::kHigher) return -value;
  return better == Better::kOne ? std::abs(value - 1.0) : value;
}

}  // namespace

Result<ResultFolder> read_result_folder(const fs::path& path) {
  ResultFolder folder{path, {}, {}, {}};
  std::error_code status;
  if (!fs::is_regular_file(path / "plan.toml", status)) {
    return fail(ErrorCode::kIo,
                "{}: no plan.toml in it: give a folder that spool evaluate -o wrote",
                path.string());
  }
  SPOOL_ASSIGN(folder.plan, read_plan(path / "plan.toml", {known_samplers(), known_filters()}));
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

Change compare_one(const ResultFolder& a, const ResultFolder& b, const Combination& before,
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

void judge(std::vector<Change>& changes, double significance, double tolerance) {
  std::vector<double> p;
  for (const Change& change : changes)
    p.push_back(change.difference.p);
  const std::vector<double> adjusted = holm_adjusted(p);
  for (std::size_t i = 0; i < changes.size(); ++i) {
    Change& change = changes[i];
    change.p = adjusted[i];
    if (change.verdict == "identical" || !(adjusted[i] < significance)) continue;
    const double before = cost(change.before, change.metric);
    const double after = cost(change.after, change.metric);
    if (std::abs(after - before) <= tolerance * std::abs(before)) continue;
    change.verdict = after > before ? "worse" : "better";
  }
}

}  // namespace spool::tools
