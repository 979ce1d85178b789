#include "tools/verbs/compare.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "lib/core/counted.h"
#include "lib/core/visible_text.h"
#include "tools/batch/result_changes.h"
#include "tools/batch/shown_results.h"
#include "tools/json/answers_json.h"
#include "tools/json/study_json.h"
#include "tools/methods/method_settings.h"
#include "tools/terminal/text_columns.h"
#include "tools/verbs/option_bounds.h"

namespace spool::tools {
namespace {

std::string shown(double value) {
  return std::isfinite(value) ? fmt::format("{:.4g}", value) : "n/a";
}

// after / before with its interval; the means alone where errors have no logarithm.
std::string change_text(const Change& change) {
  if (!change.judged_differently.empty()) return "-";
  const Interval ratio = change.difference.ratio();
  if (!std::isfinite(ratio.mean)) return shown(change.after / change.before);
  return ratio_text(ratio, 4, 4);
}

// How they were compared; times are never paired, and some errors have no logarithm.
std::string way_of(const std::vector<Change>& changes) {
  long long known = 0, paired = 0, logarithmic = 0;
  for (const Change& c : changes) {
    if (c.difference.n == 0) continue;
    ++known;
    paired += c.paired;
    logarithmic += c.difference.logarithmic;
  }
  const std::string pairs = paired == 0       ? "independent"
                            : paired == known ? "paired by replicate"
                                              : fmt::format("{} paired by replicate", paired);
  const std::string logs =
      logarithmic == known ? "on logarithms" : fmt::format("{} on logarithms", logarithmic);
  return pairs + ", " + logs;
}

long long count(const Comparisons& outcome, Verdict verdict) {
  return std::ranges::count(outcome.changes, verdict, &Change::verdict);
}

std::string text_of(const Comparisons& outcome, bool all) {
  std::vector<std::vector<std::string>> rows = {
      {"", "metric", "before", "after", "ratio (95 %)", "p (Holm)", "verdict"}};
  for (const Change& c : outcome.changes) {
    if (!all && c.verdict != Verdict::kBetter && c.verdict != Verdict::kWorse) continue;
    rows.push_back({c.key, c.metric, shown(c.before), shown(c.after), change_text(c),
                    std::isnan(c.p) ? "n/a" : fmt::format("{:.2g}", c.p),
                    std::string(verdict_name(c.verdict))});
  }
  std::string text;
  for (const auto& [claim, before, after] : outcome.claims) {
    text +=
        visible_text(before == after ? fmt::format("claim: {}: {}", claim, after)
                                     : fmt::format("claim: {}: {} -> {}", claim, before, after)) +
        "\n";
  }
  if (!text.empty()) text += "\n";
  if (rows.size() > 1) text += format_columns(rows, 2) + "\n";
  const auto list = [&](const char* what, const std::vector<std::string>& keys) {
    for (const std::string& key : keys)
      text += visible_text(fmt::format("{}: {}", what, key)) + "\n";
  };
  list("failed now", outcome.newly_failed);
  list("incomplete", outcome.incomplete);
  list("only before", outcome.only_before);
  list("only after", outcome.only_after);
  std::vector<std::string> without_error;
  for (const Change& c : outcome.changes) {
    if (c.metric != "energy_ratio" && c.metric != kCpuTime && (c.before == 0.0 || c.after == 0.0))
      without_error.push_back(c.key);
  }
  list("no error at all, like the reference itself", without_error);
  std::string notes = fmt::format(
      "{} ({}, all together): {} better, {} worse, {} undecided, "
      "{} identical, {} not compared.\n",
      counted(outcome.changes.size(), "comparison"), way_of(outcome.changes),
      count(outcome, Verdict::kBetter), count(outcome, Verdict::kWorse),
      count(outcome, Verdict::kUndecided), count(outcome, Verdict::kIdentical),
      count(outcome, Verdict::kUnknown));
  for (const Withheld why : {Withheld::kFewPixels, Withheld::kReferenceNoise}) {
    const auto count = std::ranges::count_if(
        outcome.changes, [&](const Change& c) { return c.difference.withheld == why; });
    if (count > 0)
      notes += fmt::format("Not compared for {}: {}: {}.\n", withheld_name(why), count,
                           withheld_remedy(why));
  }
  const auto alone = std::ranges::count_if(outcome.changes, [](const Change& c) {
    return c.verdict == Verdict::kUnknown && c.difference.withheld == Withheld::kNo &&
           c.judged_differently.empty();
  });
  if (alone > 0) {
    notes += fmt::format(
        "Not compared for one replicate, replicates of one image, or an infinite error: {}: read "
        "before and after.\n",
        alone);
  }
  std::map<std::string, int> judged;
  for (const Change& c : outcome.changes)
    if (!c.judged_differently.empty()) ++judged[c.judged_differently];
  for (const auto& [how, count] : judged)
    notes += visible_text(fmt::format("Judged differently, not compared: {}: by {}.", count, how)) +
             "\n";
  // What the machine did meanwhile is in every replicate of a run alike.
  if (std::ranges::find(outcome.changes, kCpuTime, &Change::metric) != outcome.changes.end())
    notes +=
        "Times are of one run each, and the machine may have changed between the two: repeat "
        "both before you believe a change, or give --tolerance what runs of one program "
        "differ by.\n";
  if (std::ranges::any_of(outcome.changes, &Change::biased))
    notes += "BIASED: judged by the samples that images were made of.\n";
  return text + wrapped(notes, line_width());
}

// By names, so that two presets of a method are compared; where a folder has several of one name,
// by names with presets.
Result<std::pair<ResultFolder, ResultFolder>> read_folders(const CompareOptions& options) {
  const auto read = [&](MatchBy match) -> Result<std::pair<ResultFolder, ResultFolder>> {
    SPOOL_ASSIGN(ResultFolder before, read_result_folder(options.before, match));
    SPOOL_ASSIGN(ResultFolder after, read_result_folder(options.after, match));
    return std::pair(std::move(before), std::move(after));
  };
  if (!options.match_name) return read(MatchBy::kLabel);
  auto by_name = read(MatchBy::kName);
  if (by_name || by_name.error().code != ErrorCode::kUsage) return by_name;
  return read(MatchBy::kPreset);
}

// Of the claims that either folder's statistics.json has; those of one text in their order.
std::vector<ClaimChange> claim_changes(const std::filesystem::path& before,
                                       const std::filesystem::path& after) {
  std::vector<ClaimChange> changes;
  const auto add = [&](const std::filesystem::path& folder, std::string ClaimChange::* side) {
    const std::string ClaimChange::* const text = &ClaimChange::text;
    std::map<std::string, std::size_t> read;
    for (const KeptClaim& claim : kept_claims(folder / "statistics.json")) {
      auto found = std::ranges::find(changes, claim.text, text);
      for (std::size_t i = read[claim.text]++; i > 0 && found != changes.end(); --i)
        found = std::ranges::find(std::next(found), changes.end(), claim.text, text);
      if (found == changes.end())
        found = changes.insert(changes.end(), {claim.text, "not asked", "not asked"});
      (*found).*side = claim.verdict;
    }
  };
  add(before, &ClaimChange::before);
  add(after, &ClaimChange::after);
  return changes;
}

Result<std::vector<std::string>> chosen_metrics(const CompareOptions& options) {
  std::vector<std::string> known = compared_metrics();
  known.emplace_back(kCpuTime);
  std::vector<std::string> chosen = split_list(options.metrics);
  for (const std::string& metric : chosen) {
    // Twice in the family, it would be charged for twice.
    if (std::ranges::count(chosen, metric) > 1)
      return fail(ErrorCode::kUsage, "--metric {}: is asked for twice: name it once", metric);
    if (std::ranges::find(known, metric) != known.end()) continue;
    return fail(ErrorCode::kUsage, "--metric {}: cannot be compared{}: one of {}", metric,
                did_you_mean(metric, known), fmt::join(known, ", "));
  }
  if (chosen.empty()) return fail(ErrorCode::kUsage, "--metric: name at least one");
  return chosen;
}

}  // namespace

Result<void> validate(const CompareOptions& options) {
  SPOOL_TRY(chosen_metrics(options));
  SPOOL_TRY(check_bounds("significance", options.significance, kSignificance));
  return check_bounds("tolerance", options.tolerance, kTolerance);
}

Result<void> run_compare(const CompareOptions& options, const CommonOptions& common) {
  SPOOL_TRY(validate(options));
  SPOOL_ASSIGN(const std::vector<std::string> metrics, chosen_metrics(options));
  SPOOL_ASSIGN(const auto folders, read_folders(options));
  const auto& [before, after] = folders;
  for (const ResultFolder* folder : {&before, &after})
    if (!folder->damage.empty()) print_warning(folder->damage);
  Comparisons outcome;
  outcome.claims = claim_changes(before.path, after.path);
  std::size_t less_complete = 0;
  const auto list_missing = [&](const ResultFolder& folder, const Combination& combination) {
    const int missing = combination.missing(), wanted = combination.wanted;
    if (missing == 0) return;
    outcome.incomplete.push_back(fmt::format("{}: {}: {} of {} replicates", folder.path.string(),
                                             combination.key, wanted - missing, wanted));
  };
  for (const auto& [key, combination] : before.combinations) {
    list_missing(before, combination);
    const auto found = after.combinations.find(key);
    if (found == after.combinations.end()) {
      outcome.only_before.push_back(combination.key);
      continue;
    }
    if (found->second.results.failed > combination.results.failed)
      outcome.newly_failed.push_back(found->second.key);
    less_complete += found->second.missing() > combination.missing();
    for (const std::string& metric : metrics)
      outcome.changes.push_back(compare_one(before, after, combination, found->second, metric));
  }
  for (const auto& [key, combination] : after.combinations) {
    list_missing(after, combination);
    if (before.combinations.contains(key)) continue;
    outcome.only_after.push_back(combination.key);
    if (combination.results.failed > 0) outcome.newly_failed.push_back(combination.key);
  }
  if (outcome.changes.empty()) {
    return fail(
        ErrorCode::kData,
        "{} and {}: have no result in common: one is of '{}', the other of '{}': recording, "
        "sampler, filter and budget must be alike (--match name: whatever the options)",
        options.before.string(), options.after.string(), before.combinations.begin()->second.key,
        after.combinations.begin()->second.key);
  }
  judge(outcome.changes, options.significance, options.tolerance);
  print(common.json ? comparisons_text(outcome) : text_of(outcome, options.all));
  const long long worse = count(outcome, Verdict::kWorse);
  const auto differently = std::ranges::count_if(
      outcome.changes, [](const Change& c) { return !c.judged_differently.empty(); });
  if (worse == 0 && outcome.newly_failed.empty() && outcome.only_before.empty() &&
      less_complete == 0 && differently == 0)
    return {};
  return fail(
      ErrorCode::kData,
      "{}: {} worse, {} failed, {} missing, {} incomplete, {} judged differently against {}",
      options.after.string(), worse, outcome.newly_failed.size(), outcome.only_before.size(),
      less_complete, differently, options.before.string());
}

}  // namespace spool::tools
