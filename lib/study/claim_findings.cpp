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

}  // namespace

PlaceClaims claims_at(const Plan& plan, const StudyPlace& place, std::size_t budget,
                      const SceneMethods& methods) {
  const auto with = [&](int threads) -> const std::vector<MethodResults>& {
    const auto at = std::ranges::find(plan.threads, threads) - plan.threads.begin();
    return methods[static_cast<std::size_t>(at)][budget];
  };
  std::vector<Comparison> comparisons;
  std::vector<double> below;
  for (const Claim& claim : plan.claims) {
    if (!claim.asks(place.spp, place.threads)) continue;
    const int than = claim.than_threads > 0 ? claim.than_threads : place.threads;
    comparisons.push_back(compared(claim, with(place.threads), with(than)));
    below.push_back(claim.below);
  }
  const std::vector<JudgedClaim> judged = judge_claims(comparisons, below);
  PlaceClaims found{place, {}, std::ranges::any_of(with(place.threads), &MethodResults::biased)};
  auto next = judged.begin();
  for (const Claim& claim : plan.claims)
    found.judged.push_back(claim.asks(place.spp, place.threads) ? std::optional(*next++)
                                                                : std::nullopt);
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
