#include "lib/study/claim_findings.h"

#include <algorithm>

namespace spool {
namespace {

const MethodResults* method_named(const std::vector<MethodResults>& methods,
                                  const std::string& name) {
  const auto found =
      std::ranges::find_if(methods, [&](const MethodResults& m) { return m.name() == name; });
  return found == methods.end() || found->one_image() ? nullptr : &*found;
}

// Times of a machine that other results shared are not compared.
Comparison compared(const Claim& claim, const std::vector<MethodResults>& methods,
                    const std::vector<MethodResults>& others) {
  const MethodResults* better = method_named(methods, claim.better);
  const MethodResults* than = method_named(others, claim.than);
  if (!better || !than) return {};
  if (is_time(claim.metric) && (better->shared_machine || than->shared_machine)) return {};
  const auto series = [&](const MethodResults& method) {
    return claim.fresh ? method.fresh_series(claim.metric)
                       : method.series(quantity_index(claim.metric));
  };
  return compare_paired(series(*better), series(*than), better_of(claim.metric));
}

// An error does not depend on the number of threads: it is asked of once.
bool asked(const Claim& claim, const Plan& plan, const StudyPlace& place) {
  return claim.asks(place.spp, place.threads) &&
         (is_time(claim.metric) || claim.threads > 0 || place.threads == plan.threads.front());
}

}  // namespace

std::vector<PlaceClaims> claims_at(const Plan& plan, const PlanScene& scene, std::size_t budget,
                                   const SceneMethods& methods) {
  const auto with = [&](int threads) -> const std::vector<MethodResults>& {
    const auto at = std::ranges::find(plan.threads, threads) - plan.threads.begin();
    return methods[static_cast<std::size_t>(at)][budget];
  };
  std::vector<PlaceClaims> found;
  std::vector<Comparison> comparisons;
  std::vector<double> below;
  for (const int threads : plan.threads) {
    const StudyPlace at{scene.recordings.front(), plan.spp[budget], threads, scene.group};
    PlaceClaims& place = found.emplace_back(
        PlaceClaims{at, {}, std::ranges::any_of(with(threads), &MethodResults::biased)});
    for (const Claim& claim : plan.claims) {
      place.judged.emplace_back();
      if (!asked(claim, plan, at)) continue;
      place.judged.back().emplace();
      const int than = claim.than_threads > 0 ? claim.than_threads : threads;
      comparisons.push_back(compared(claim, with(threads), with(than)));
      below.push_back(claim.below);
    }
  }
  const std::vector<JudgedClaim> judged = judge_claims(comparisons, below);
  auto next = judged.begin();
  for (PlaceClaims& place : found) {
    for (std::optional<JudgedClaim>& claim : place.judged)
      if (claim) claim = *next++;
  }
  return found;
}

std::vector<ClaimFinding> claim_findings(const Plan& plan, const std::vector<PlaceClaims>& places) {
  std::vector<ClaimFinding> findings;
  for (std::size_t c = 0; c < plan.claims.size(); ++c) {
    ClaimFinding& finding = findings.emplace_back();
    finding.claim = plan.claims[c];
    std::vector<ClaimVerdict> verdicts;
    for (const PlaceClaims& place : places) {
      if (!place.judged[c]) continue;
      finding.places.push_back({place.place, *place.judged[c], place.biased});
      verdicts.push_back(place.judged[c]->verdict);
    }
    finding.verdict = verdict_over(verdicts);
  }
  return findings;
}

}  // namespace spool
