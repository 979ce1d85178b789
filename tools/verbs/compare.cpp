#include "tools/verbs/compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "formats/bounded_json.h"
#include "lib/core/visible_text.h"
#include "tools/batch/result_changes.h"
#include "tools/methods/method_settings.h"
#include "tools/terminal/json_text.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

std::string shown(double value) {
  return std::isfinite(value) ? fmt::format("{:.4g}", value) : "n/a";
}

ordered_json number(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

// after / before with its interval; the means alone where errors have no logarithm.
std::string ratio_text(const Change& change) {
  const Interval ratio = change.difference.ratio();
  if (!std::isfinite(ratio.mean)) return shown(change.after / change.before);
  return fmt::format("{} [{}, {}]", shown(ratio.mean), shown(ratio.low), shown(ratio.high));
}

struct Outcome {
  std::vector<Change> changes;
  std::vector<std::array<std::string, 3>> claims;  // text, verdict before and after

  long long count(Verdict verdict) const {
    return std::ranges::count(changes, verdict, &Change::verdict);
  }
  std::vector<std::string> only_before, only_after, newly_failed;
};

std::string text_of(const Outcome& outcome, bool all) {
  std::vector<std::vector<std::string>> rows = {
      {"", "metric", "before", "after", "ratio (95 %)", "p (Holm)", "verdict"}};
  bool biased = false;
  for (const Change& c : outcome.changes) {
    biased = biased || c.biased;
    if (!all && c.verdict != Verdict::kBetter && c.verdict != Verdict::kWorse) continue;
    rows.push_back({c.key, c.metric, shown(c.before), shown(c.after), ratio_text(c),
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
  list("only before", outcome.only_before);
  list("only after", outcome.only_after);
  const bool paired = std::ranges::any_of(outcome.changes, &Change::paired);
  text += fmt::format(
      "{} comparisons ({}, on logarithms, all together): {} better, {} worse, {} undecided, "
      "{} identical, {} not compared.\n",
      outcome.changes.size(), paired ? "paired by replicate" : "independent",
      outcome.count(Verdict::kBetter), outcome.count(Verdict::kWorse),
      outcome.count(Verdict::kUndecided), outcome.count(Verdict::kIdentical),
      outcome.count(Verdict::kUnknown));
  for (const Withheld why : {Withheld::kFewPixels, Withheld::kReferenceNoise}) {
    const auto count = std::ranges::count_if(
        outcome.changes, [&](const Change& c) { return c.difference.withheld == why; });
    if (count > 0)
      text += fmt::format("Not compared for {}: {}: {}.\n", withheld_name(why), count,
                          withheld_remedy(why));
  }
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
                    {"ratio", number(c.difference.ratio().mean)},
                    {"low", number(c.difference.ratio().low)},
                    {"high", number(c.difference.ratio().high)},
                    {"p_holm", number(c.p)},
                    {"paired", c.paired},
                    {"biased", c.biased},
                    {"verdict", verdict_name(c.verdict)}});
    if (c.difference.withheld != Withheld::kNo)
      list.back()["withheld"] = withheld_name(c.difference.withheld);
  }
  ordered_json claims = ordered_json::array();
  for (const auto& [text, before, after] : outcome.claims)
    claims.push_back({{"text", text}, {"before", before}, {"after", after}});
  const ordered_json root = {{"claims", claims},
                             {"comparisons", list},
                             {"newly_failed", outcome.newly_failed},
                             {"only_before", outcome.only_before},
                             {"only_after", outcome.only_after}};
  return json_text(root);
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

// [text, verdict before, verdict after] of the claims that either folder's statistics.json has.
std::vector<std::array<std::string, 3>> claim_changes(const std::filesystem::path& before,
                                                      const std::filesystem::path& after) {
  std::vector<std::array<std::string, 3>> changes;
  const auto add = [&](const std::filesystem::path& folder, std::size_t side) {
    const auto json = format::parse_json_file<ordered_json>(folder / "statistics.json");
    if (!json.is_object() || !json.contains("claims") || !json["claims"].is_array()) return;
    for (const ordered_json& claim : json["claims"]) {
      const auto text_of = [&](const char* key) {
        const bool known = claim.is_object() && claim.contains(key) && claim[key].is_string();
        return known ? claim[key].get<std::string>() : std::string();
      };
      const std::string text = text_of("text");
      auto found = std::ranges::find_if(changes, [&](const auto& c) { return c[0] == text; });
      if (found == changes.end())
        found = changes.insert(changes.end(), {text, "not asked", "not asked"});
      (*found)[side] = text_of("verdict");
    }
  };
  add(before, 1);
  add(after, 2);
  return changes;
}

Result<std::vector<std::string>> chosen_metrics(const CompareOptions& options) {
  std::vector<std::string> known = compared_metrics();
  known.emplace_back(kCpuTime);
  std::vector<std::string> chosen = split_list(options.metrics);
  for (const std::string& metric : chosen) {
    if (std::ranges::find(known, metric) != known.end()) continue;
    return fail(ErrorCode::kUsage, "--metric {}: cannot be compared{}: one of {}", metric,
                did_you_mean(metric, known), fmt::join(known, ", "));
  }
  if (chosen.empty()) return fail(ErrorCode::kUsage, "--metric: name at least one");
  return chosen;
}

}  // namespace

Result<void> run_compare(const CompareOptions& options, const CommonOptions& common) {
  SPOOL_ASSIGN(const std::vector<std::string> metrics, chosen_metrics(options));
  SPOOL_ASSIGN(const auto folders, read_folders(options));
  const auto& [before, after] = folders;
  Outcome outcome;
  outcome.claims = claim_changes(before.path, after.path);
  for (const auto& [key, combination] : before.combinations) {
    const auto found = after.combinations.find(key);
    if (found == after.combinations.end()) {
      outcome.only_before.push_back(combination.key);
      continue;
    }
    if (found->second.results.failed > 0 && combination.results.failed == 0)
      outcome.newly_failed.push_back(found->second.key);
    for (const std::string& metric : metrics)
      outcome.changes.push_back(compare_one(before, after, combination, found->second, metric));
  }
  for (const auto& [key, combination] : after.combinations) {
    if (!before.combinations.contains(key)) outcome.only_after.push_back(combination.key);
  }
  if (outcome.changes.empty()) {
    return fail(ErrorCode::kData, "{} and {}: have no result in common", options.before.string(),
                options.after.string());
  }
  judge(outcome.changes, options.significance, options.tolerance);
  print(common.json ? json_of(outcome) : text_of(outcome, options.all));
  const long long worse = outcome.count(Verdict::kWorse);
  if (worse == 0 && outcome.newly_failed.empty() && outcome.only_before.empty()) return {};
  return fail(ErrorCode::kData, "{}: {} worse, {} failed, {} missing against {}",
              options.after.string(), worse, outcome.newly_failed.size(),
              outcome.only_before.size(), options.before.string());
}

}  // namespace spool::tools
