#include "tools/json/compare_json.h"

#include <nlohmann/json.hpp>

#include "tools/json/json_text.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

ordered_json change_json(const Change& change) {
  const Interval ratio = change.difference.ratio();
  ordered_json entry = {{"combination", change.key},
                        {"metric", change.metric},
                        {"before", json_number(change.before)},
                        {"after", json_number(change.after)},
                        {"ratio", json_number(ratio.mean)},
                        {"low", json_number(ratio.low)},
                        {"high", json_number(ratio.high)},
                        {"p_holm", json_number(change.p)},
                        {"paired", change.paired},
                        {"biased", change.biased},
                        {"verdict", verdict_name(change.verdict)}};
  if (change.difference.withheld != Withheld::kNo)
    entry["withheld"] = withheld_name(change.difference.withheld);
  return entry;
}

}  // namespace

std::string comparisons_text(const Comparisons& comparisons) {
  ordered_json claims = ordered_json::array(), changes = ordered_json::array();
  for (const ClaimChange& claim : comparisons.claims)
    claims.push_back({{"text", claim.text}, {"before", claim.before}, {"after", claim.after}});
  for (const Change& change : comparisons.changes)
    changes.push_back(change_json(change));
  return json_text({{"claims", claims},
                    {"comparisons", changes},
                    {"newly_failed", comparisons.newly_failed},
                    {"only_before", comparisons.only_before},
                    {"only_after", comparisons.only_after}});
}

}  // namespace spool::tools
