#include "lib/study/ranked_results.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

namespace spool {

std::vector<RankedResult> ranked_results(const Study& study) {
  constexpr std::size_t kLast = std::numeric_limits<std::size_t>::max();
  std::vector<RankedResult> all(study.results.size());
  std::vector<std::size_t> rank(all.size(), kLast), place(all.size());
  std::map<StudyPlace, std::size_t> places;
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].result = &study.results[i];
    if (all[i].result->replicates > 0)
      place[i] = places.try_emplace(all[i].place(), places.size()).first->second;
  }
  for (const ConditionFinding& condition : study.conditions) {
    for (std::size_t r = 0; r < condition.ranking.size(); ++r) {
      const RankedFinding& ranked = condition.ranking[r];
      if (condition.metric == "mse") all[ranked.result].mse = &ranked;
      if (condition.metric != "relmse") continue;
      all[ranked.result].relmse = &ranked;
      rank[ranked.result] = r;
    }
  }
  std::vector<std::size_t> order(all.size());
  std::iota(order.begin(), order.end(), 0);
  std::erase_if(order, [&](std::size_t i) { return all[i].result->replicates == 0; });
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return std::pair(place[i], rank[i]); });
  std::vector<RankedResult> ordered;
  for (const std::size_t i : order)
    ordered.push_back(all[i]);
  return ordered;
}

}  // namespace spool
