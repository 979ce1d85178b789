#include "tools/batch/evaluation_summary.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <vector>

#include "lib/core/visible_text.h"
#include "tools/batch/shown_results.h"
#include "tools/batch/summary_notes.h"
#include "tools/methods/external_methods.h"
#include "tools/terminal/console.h"

namespace spool::tools {
namespace {

constexpr std::size_t kLongestTable = 200;  // lines; beyond, the best of each condition
constexpr std::size_t kBestShown = 5;

using Rows = std::vector<std::vector<std::string>>;

std::string claims_text(const std::vector<ClaimFinding>& claims) {
  std::string text;
  for (const ClaimFinding& finding : claims) {
    text += fmt::format("claim: {}: {}{}\n", visible_text(finding.claim.text),
                        claim_verdict_name(finding.verdict),
                        finding.after_results ? " (added after results)" : "");
    for (const auto& [place, judged] : finding.places) {
      const Interval ratio = judged.comparison.ratio();
      const bool known = std::isfinite(ratio.low) && std::isfinite(ratio.high);
      text += fmt::format("  {} {:g} spp: {}{}\n", visible_text(shown_scene(place.recording)),
                          place.spp, claim_verdict_name(judged.verdict),
                          known ? " " + value_text(ratio, "{:.3g}") : "");
    }
  }
  return text.empty() ? text : text + "\n";
}

std::string baseline_ratio(const RankedFinding* ranked) {
  return ranked && ranked->ratio ? ratio_text(*ranked->ratio) : "-";
}

std::string verdict_text(const RankedFinding* ranked) {
  if (!ranked) return "-";
  if (ranked->withheld != Withheld::kNo || ranked->baseline_withheld != Withheld::kNo)
    return "no verdict";
  return ranked->against_baseline ? std::string(verdict_name(*ranked->against_baseline)) : "-";
}

std::string energy_text(const RankedResult& result) {
  const Interval& energy = result.quantity("energy_ratio");
  if (!std::isfinite(energy.mean)) return "n/a";
  const std::string text = fmt::format("{:.3f}", energy.mean);
  return result.relmse && result.relmse->loses_energy ? text + " (loses)" : text;
}

ShownResults best_of_each(const ShownResults& results) {
  std::map<StudyPlace, std::size_t> taken;
  ShownResults best;
  for (const RankedResult& result : results) {
    if (++taken[result.place()] <= kBestShown && best.size() < kLongestTable)
      best.push_back(result);
  }
  return best;
}

bool any_has_threads(const Study& study) {
  return std::ranges::any_of(study.results,
                             [](const MethodFinding& r) { return r.place.threads != 0; });
}

// Method, relMSE, ratio, verdict, below a heading for each scene and budget: 80 columns hold it.
std::string short_table(const Study& study, const ShownResults& shown) {
  const bool threads = any_has_threads(study);
  Rows rows = {{"", "relMSE", "ratio", "than baseline"}};
  std::vector<std::string> headings = {""};
  for (const RankedResult& result : shown) {
    const StudyPlace& place = result.place();
    const std::string name = shown_method(result);
    rows.push_back({"  " + name, value_text(result.quantity("relmse"), "{:.3g}"),
                    baseline_ratio(result.relmse),
                    name == study.baseline ? "(baseline)" : verdict_text(result.relmse)});
    headings.push_back(fmt::format("{}, {:g} samples per pixel{}", shown_scene(place.recording),
                                   place.spp,
                                   threads ? fmt::format(", {} threads", place.threads) : ""));
  }
  std::istringstream lines(format_columns(rows, 1));
  std::string text, line, last;
  for (std::size_t i = 0; std::getline(lines, line); ++i) {
    if (headings[i] != last) text += visible_text(headings[i]) + "\n";
    last = headings[i];
    text += line + "\n";
  }
  return text;
}

std::string wide_table(const Study& study, const ShownResults& shown) {
  const bool threads = any_has_threads(study);
  Rows rows = {{"dump", "sampler", "filter", "spp", "spent", "relMSE", "ratio", "than baseline",
                "MSE", "ratio", "energy", "sampling", "filtering"}};
  if (threads) rows.front().emplace_back("threads");
  for (const RankedResult& result : shown) {
    rows.push_back({shown_scene(result.place().recording), shown_sampler(result),
                    shown_filter(result), fmt::format("{:g}", result.place().spp),
                    fmt::format("{:.4g}", mean_or(result.quantity("samples_per_pixel"), 0.0)),
                    value_text(result.quantity("relmse")), baseline_ratio(result.relmse),
                    verdict_text(result.relmse), value_text(result.quantity("mse")),
                    baseline_ratio(result.mse), energy_text(result),
                    format_seconds(mean_or(result.quantity("seconds_sampling"), 0.0)),
                    format_seconds(mean_or(result.quantity("seconds_filtering"), 0.0))});
    if (threads) rows.back().push_back(std::to_string(result.place().threads));
  }
  return format_columns(rows, 3);
}

// relMSE in the baseline's processor time.
std::string equal_time_table(const std::vector<CurveFinding>& curves) {
  Rows rows = {
      {"dump", "sampler", "filter", "spp of baseline", "its CPU time", "relMSE ratio then"}};
  for (const CurveFinding& curve : curves) {
    if (curve.metric != "relmse") continue;
    for (const auto& [at, seconds, found] : curve.equal_time) {
      const bool outside = found.too_slow || found.too_fast;
      rows.push_back(
          {shown_scene(curve.recording), curve.methods.sampler, curve.methods.filter,
           fmt::format("{:g}", at), std::isfinite(seconds) ? format_seconds(seconds) : "n/a",
           outside ? (found.too_slow ? "too slow" : "too fast") : ratio_text(found.ratio)});
    }
  }
  if (rows.size() == 1) return "";
  return "\nIn the processor time of the baseline (too slow, too fast: at all budgets here)\n" +
         format_columns(rows, 3);
}

// What intervals and verdicts on relMSE are about. One of each kind: where replicates share
// samples, that with the most.
std::string about_text(const Study& study) {
  std::map<std::string, About> kinds;
  for (const ConditionFinding& condition : study.conditions) {
    if (condition.metric != "relmse") continue;
    About& kept = kinds[condition.about.kind];
    if (kept.text.empty() || condition.about.shared > kept.shared) kept = condition.about;
  }
  std::string text;
  for (const auto& [kind, about] : kinds)
    text += fmt::format("About {}.\n", visible_text(about.text));
  return text;
}

}  // namespace

std::string summary_text(const Study& study, bool wide) {
  const ShownResults all = ranked_results(study);
  if (all.empty()) return "no results\n";
  const bool shortened = all.size() > kLongestTable;
  const ShownResults shown = shortened ? best_of_each(all) : all;
  std::string text = claims_text(study.claims);
  text +=
      wide ? wide_table(study, shown) + equal_time_table(study.curves) : short_table(study, shown);
  text += fmt::format(
      "\nMean [95 % interval], best first; ratio to {} at the same budget. Verdicts: all pairs of\n"
      "a recording and budget together at 5 %.{}\n",
      visible_text(study.baseline), wide ? "" : " MSE, energy, times: --wide.");
  if (shortened) {
    text += fmt::format("The {} best by relMSE of each recording and budget, of {} in all.\n",
                        kBestShown, all.size());
  }
  text += would_tell_text(shown) + support_text(shown) + losses_text(shown) + exchange_text(shown);
  if (std::ranges::any_of(shown, is_described_sampler) ||
      std::ranges::any_of(shown, is_described_filter))
    text += fmt::format("{}.\n", kByDescription);
  if (std::ranges::any_of(shown, [](const RankedResult& r) { return r.result->one_image; })) {
    text +=
        "Where all replicates are one image, the interval is that of its blocks of pixels and "
        "nothing is compared. An image made elsewhere is judged beside methods that got the same "
        "samples with --recorded-order --replicates 1.\n";
  }
  const bool biased = std::ranges::any_of(study.conditions, &ConditionFinding::biased);
  text += about_text(study);
  text += fmt::format("Judged by: {}{}.\n", visible_text(all.front().result->reference),
                      biased ? " (BIASED: see spool evaluate --help)" : "");
  return text;
}

}  // namespace spool::tools
