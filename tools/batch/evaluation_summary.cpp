#include "tools/batch/evaluation_summary.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <vector>

#include "lib/core/counted.h"
#include "lib/core/visible_text.h"
#include "lib/experiment/reference.h"
#include "tools/batch/shown_results.h"
#include "tools/batch/summary_notes.h"
#include "tools/methods/external_methods.h"
#include "tools/terminal/console.h"

namespace spool::tools {
namespace {

constexpr std::size_t kLongestTable = 200;  // lines; beyond, the best of each condition
constexpr std::size_t kBestShown = 5;

using Rows = std::vector<std::vector<std::string>>;

std::string withheld_text(Withheld withheld) {
  return withheld == Withheld::kNo ? "" : fmt::format(" ({})", withheld_name(withheld));
}

std::string claims_text(const std::vector<ClaimFinding>& claims) {
  std::string text;
  for (const ClaimFinding& finding : claims) {
    text += fmt::format("claim: {}: {}{}\n", visible_text(finding.claim.text),
                        claim_verdict_name(finding.verdict),
                        finding.after_results ? " (added after results)" : "");
    for (const auto& [place, judged, biased] : finding.places) {
      const Interval ratio = judged.comparison.ratio();
      const bool known = std::isfinite(ratio.low) && std::isfinite(ratio.high);
      text += fmt::format(
          "  {} {:g} spp{}: {}{}\n", visible_text(shown_scene(place)), place.spp,
          is_time(finding.claim.metric) && place.threads > 0
              ? fmt::format(", {}", counted(static_cast<std::uint64_t>(place.threads), "thread"))
              : "",
          claim_verdict_name(judged.verdict),
          known ? " " + ratio_text(ratio) : withheld_text(judged.comparison.withheld));
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

// With the baseline, which the ratios of the others are to.
ShownResults best_of_each(const ShownResults& results, const std::string& baseline) {
  std::map<StudyPlace, std::size_t> taken;
  ShownResults best;
  for (const RankedResult& result : results) {
    const bool among =
        ++taken[result.place()] <= kBestShown || result.result->methods.name() == baseline;
    if (among && best.size() < kLongestTable) best.push_back(result);
  }
  return best;
}

bool any_has_threads(const Study& study) {
  return std::ranges::any_of(study.results,
                             [](const MethodFinding& r) { return r.place.threads != 0; });
}

// Method, relMSE, ratio, verdict, below a heading for each scene and budget. A ratio has its
// interval where there is room.
Rows short_rows(const Study& study, const ShownResults& shown, bool ratio_intervals) {
  const bool threads = any_has_threads(study);
  Rows rows = {{"", "relMSE", "ratio", "verdict"}};
  std::string last;
  for (const RankedResult& result : shown) {
    const StudyPlace& place = result.place();
    const std::string heading = fmt::format(
        "{}, {:g} sample{} per pixel{}", shown_scene(place), place.spp, place.spp == 1.0 ? "" : "s",
        threads ? ", " + counted(static_cast<std::size_t>(place.threads), "thread") : "");
    if (heading != last) rows.push_back({heading});
    last = heading;
    const bool is_baseline = result.result->methods.name() == study.baseline;
    std::string ratio = baseline_ratio(result.relmse);
    if (!ratio_intervals) ratio.resize(std::min(ratio.find(' '), ratio.size()));
    rows.push_back({"  " + shown_method(result), value_text(result.quantity("relmse"), "{:.3g}"),
                    ratio, is_baseline ? "(baseline)" : verdict_text(result.relmse)});
  }
  return rows;
}

std::string short_table(const Study& study, const ShownResults& shown) {
  const std::size_t width = line_width();
  const std::string text = format_columns(short_rows(study, shown, true), 1, 0);
  std::istringstream lines(text);
  bool fits = true;
  for (std::string line; std::getline(lines, line);)
    fits = fits && (width == 0 || column_count(line) <= width);
  return fits ? text : format_columns(short_rows(study, shown, false), 1, width);
}

std::string wide_table(const Study& study, const ShownResults& shown) {
  const bool threads = any_has_threads(study);
  Rows rows = {{"recording", "sampler", "filter", "spp", "spent", "relMSE", "ratio",
                "than baseline", "MSE", "ratio", "energy", "sampling", "filtering"}};
  if (threads) rows.front().emplace_back("threads");
  for (const RankedResult& result : shown) {
    rows.push_back({shown_scene(result.place()), shown_sampler(result), shown_filter(result),
                    fmt::format("{:g}", result.place().spp),
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
std::string equal_time_table(const std::vector<CurveFinding>& curves, bool threads) {
  Rows rows = {
      {"recording", "sampler", "filter", "spp of baseline", "its CPU time", "relMSE ratio then"}};
  if (threads) rows.front().emplace_back("threads");
  for (const CurveFinding& curve : curves) {
    if (curve.metric != "relmse") continue;
    for (const auto& [at, seconds, found] : curve.equal_time) {
      const bool outside = found.too_slow || found.too_fast;
      rows.push_back(
          {shown_scene(curve.recording, curve.group), curve.methods.sampler, curve.methods.filter,
           fmt::format("{:g}", at), std::isfinite(seconds) ? format_seconds(seconds) : "n/a",
           outside ? (found.too_slow ? "too slow" : "too fast") : ratio_text(found.ratio)});
      if (threads) rows.back().push_back(std::to_string(curve.threads));
    }
  }
  if (rows.size() == 1) return "";
  return "\nIn the processor time of the baseline (too slow, too fast: at all budgets here)\n" +
         format_columns(rows, 3);
}

// What intervals and verdicts on relMSE are about. Where replicates share samples at some budgets
// and not at others, what is said of the budget at which they share the most.
std::string about_text(const Study& study) {
  std::map<std::string, About> kinds;
  for (const ConditionFinding& condition : study.conditions) {
    if (condition.metric != "relmse") continue;
    About& kept = kinds[condition.about.kind];
    if (kept.text.empty() || condition.about.shared > kept.shared) kept = condition.about;
  }
  if (kinds.contains("shared")) kinds.erase("disjoint");
  std::string text;
  for (const auto& [kind, about] : kinds)
    text += fmt::format("About {}.\n", visible_text(about.text));
  return text;
}

// A result names a biased kind with a mark behind it. The recording may have a reference that was
// not chosen, so what would be less noisy is named.
std::string judged_text(const std::string& reference, bool biased) {
  const auto kind =
      std::ranges::find(reference_kinds(), reference.substr(0, reference.find(" (biased)")),
                        &ReferenceDescription::name);
  const bool known = kind != reference_kinds().end();
  const bool noisier = known && !kind->biased && kind->kind != ReferenceKind::kIndependent;
  return fmt::format(
      "Judged by {}{}.{}{}\n", visible_text(reference), known ? ": " + kind->meaning : "",
      noisier ? " A reference in the recording (independent) would be less noisy." : "",
      biased ? " BIASED: see spool evaluate --help." : "");
}

// What stands below the table.
std::string remarks_text(const Study& study, const ShownResults& shown, const ShownResults& all,
                         bool wide) {
  const bool compared = std::ranges::any_of(all, [&](const RankedResult& result) {
    return result.result->methods.name() == study.baseline;
  });
  std::string text = fmt::format(
      "Mean [95 % interval], best first; {}. Verdicts: all pairs of a recording and budget "
      "together at 5 %.{}\n",
      compared ? fmt::format("ratio to {} at the same budget", visible_text(study.baseline))
               : "no ratio without a baseline (--baseline 'SAMPLER + FILTER', or in the plan)",
      wide ? "" : " MSE, energy, times: --wide.");
  if (shown.size() < all.size()) {
    text += fmt::format("The {} best by relMSE of each recording and budget{}, of {} in all.\n",
                        kBestShown, compared ? " and the baseline" : "", all.size());
  }
  text += would_decide_text(shown) + support_text(shown, wide) + light_text(shown) +
          exchange_text(shown) + imported_text(study);
  if (std::ranges::any_of(shown, is_described_sampler) ||
      std::ranges::any_of(shown, is_described_filter))
    text += fmt::format("{}.\n", kByDescription);
  if (std::ranges::any_of(shown, [](const RankedResult& r) { return r.result->one_image; })) {
    text +=
        "Where all replicates are one image, the interval is that of its blocks of pixels and "
        "nothing is compared. An image made elsewhere is judged beside methods that got the same "
        "samples with --recorded-order --replicates 1, or by replicates with --export-inputs.\n";
  }
  const bool biased = std::ranges::any_of(study.conditions, &ConditionFinding::biased);
  return text + about_text(study) + judged_text(shown.front().result->reference, biased);
}

}  // namespace

std::string summary_text(const Study& study, bool wide) {
  const ShownResults all = ranked_results(study);
  if (all.empty()) return "no results\n";
  const ShownResults shown = all.size() > kLongestTable ? best_of_each(all, study.baseline) : all;
  const std::string table =
      wide ? wide_table(study, shown) + equal_time_table(study.curves, any_has_threads(study))
           : short_table(study, shown);
  return wrapped(claims_text(study.claims), line_width()) + table + "\n" +
         wrapped(remarks_text(study, shown, all, wide), line_width());
}

}  // namespace spool::tools
