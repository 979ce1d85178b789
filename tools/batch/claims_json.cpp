#include "tools/batch/claims_json.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>

#include "lib/core/visible_text.h"
#include "tools/batch/condition_json.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

const MethodResults* method_named(const std::vector<MethodResults>& methods,
                                  const std::string& name) {
  const auto found =
      std::ranges::find_if(methods, [&](const MethodResults& m) { return m.name() == name; });
  return found == methods.end() || found->one_image() ? nullptr : &*found;
}

Comparison compared(const Claim& claim, const std::vector<MethodResults>& methods) {
  const MethodResults* better = method_named(methods, claim.better);
  const MethodResults* than = method_named(methods, claim.than);
  if (!better || !than) return {};
  const auto series = [&](const MethodResults& method) {
    return claim.fresh ? method.fresh_series(claim.metric)
                       : method.series(quantity_index(claim.metric));
  };
  return compare_paired(series(*better), series(*than),
                        metrics()[static_cast<std::size_t>(metric_index(claim.metric))].better);
}

ordered_json place_json(const ClaimPlace& place, const JudgedClaim& judged, const Claim& claim) {
  ordered_json entry = {{"dump", place.scene.recordings.front()},
                        {"spp", place.spp},
                        {"threads", place.threads},
                        {"verdict", claim_verdict_name(judged.verdict)},
                        {"ratio", interval_json(judged.comparison.ratio())},
                        {"p", json_number(judged.p)},
                        {"replicates", judged.comparison.n}};
  if (!judged.comparison.logarithmic && judged.comparison.known()) {
    entry["difference"] = {judged.comparison.difference, judged.comparison.low,
                           judged.comparison.high};
  }
  if (judged.comparison.withheld != Withheld::kNo)
    entry["withheld"] = withheld_name(judged.comparison.withheld);
  if (claim.fresh) entry["samples"] = "fresh";
  return entry;
}

std::string ratio_text(const ordered_json& place) {
  const ordered_json& ratio = place["ratio"];
  if (ratio.size() < 3) return "";
  return fmt::format(" {:.3g} [{:.3g}, {:.3g}]", ratio[0].get<double>(), ratio[1].get<double>(),
                     ratio[2].get<double>());
}

}  // namespace

ClaimPlace judge_claims(const Plan& plan, const PlanScene& scene, double spp, int threads,
                        const std::vector<MethodResults>& methods) {
  ClaimPlace place{scene, spp, threads, {}, {}};
  std::vector<Comparison> comparisons;
  std::vector<double> below;
  for (const Claim& claim : plan.claims) {
    place.asked.push_back(claim.asks(spp));
    if (!place.asked.back()) continue;
    comparisons.push_back(compared(claim, methods));
    below.push_back(claim.below);
  }
  const std::vector<JudgedClaim> judged = spool::judge_claims(comparisons, below);
  auto next = judged.begin();
  for (const bool asked : place.asked)
    place.judged.push_back(asked ? *next++ : JudgedClaim{});
  return place;
}

ordered_json claims_json(const Plan& plan, const std::vector<ClaimPlace>& places) {
  ordered_json list = ordered_json::array();
  for (std::size_t c = 0; c < plan.claims.size(); ++c) {
    const Claim& claim = plan.claims[c];
    std::vector<ClaimVerdict> verdicts;
    std::map<std::string, int> counts;
    ordered_json at = ordered_json::array();
    for (const ClaimPlace& place : places) {
      if (!place.asked[c]) continue;
      verdicts.push_back(place.judged[c].verdict);
      ++counts[std::string(claim_verdict_name(verdicts.back()))];
      at.push_back(place_json(place, place.judged[c], claim));
    }
    ordered_json entry = {{"text", claim.text},
                          {"better", claim.better},
                          {"than", claim.than},
                          {"metric", claim.metric},
                          {"samples", claim.fresh ? "fresh" : "own"},
                          {"below", claim.below},
                          {"verdict", claim_verdict_name(verdict_over(verdicts))},
                          {"counts", counts},
                          {"places", std::move(at)}};
    if (!claim.spp.empty()) entry["spp"] = claim.spp;
    if (!claim.source.empty()) entry["source"] = claim.source;
    list.push_back(std::move(entry));
  }
  return list;
}

std::string claims_text(const ordered_json& statistics) {
  std::string text;
  for (const ordered_json& claim : statistics.value("claims", ordered_json::array())) {
    text += fmt::format("claim: {}: {}{}\n", visible_text(claim["text"].get<std::string>()),
                        claim["verdict"].get<std::string>(),
                        claim.contains("after_results") ? " (added after results)" : "");
    for (const ordered_json& place : claim["places"]) {
      const std::filesystem::path dump = place["dump"].get<std::string>();
      text += fmt::format("  {} {:g} spp: {}{}\n", visible_text(dump.stem().string()),
                          place["spp"].get<double>(), place["verdict"].get<std::string>(),
                          ratio_text(place));
    }
  }
  return text.empty() ? text : text + "\n";
}

}  // namespace spool::tools
