#include "lib/inference/ranking.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lib/inference/letter_groups.h"

namespace spool {
namespace {

// Smaller is better; a mean that is not known comes last.
double order_of(const RankedMethod& ranked, const Series& series, Better better, bool logarithmic) {
  const double mean =
      ranked.compared
          ? mean_error(costs(series, better, logarithmic), 0.0, {}, series.recordings).mean
          : cost(ranked.mean.mean, better, false);
  return std::isnan(mean) ? std::numeric_limits<double>::infinity() : mean;
}

// Places in the sorted list that are compared.
std::vector<std::pair<std::size_t, std::size_t>> wanted_pairs(const Ranking& ranking,
                                                              std::size_t compared,
                                                              const RankOptions& options) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  const bool all = compared <= options.most_paired;
  for (std::size_t i = 0; i < compared; ++i) {
    for (std::size_t j = i + 1; j < compared; ++j) {
      const bool with_baseline = options.baseline == ranking.methods[i].method ||
                                 options.baseline == ranking.methods[j].method;
      if (all || i == 0 || with_baseline) pairs.emplace_back(i, j);
    }
  }
  return pairs;
}

void set_letters(Ranking& ranking, std::size_t compared) {
  std::vector<std::vector<bool>> apart(compared, std::vector<bool>(compared, false));
  std::size_t k = 0;
  for (std::size_t i = 0; i < compared; ++i) {
    for (std::size_t j = i + 1; j < compared; ++j) {
      const Verdict verdict = ranking.pairs[k++].verdict;
      apart[i][j] = verdict == Verdict::kBetter || verdict == Verdict::kWorse;
    }
  }
  const std::vector<std::string> letters =
      letter_groups(compared, [&](std::size_t i, std::size_t j) { return apart[i][j]; });
  for (std::size_t i = 0; i < compared; ++i)
    ranking.methods[i].letters = letters[i];
}

}  // namespace

const PairVerdict* Ranking::pair(std::size_t a, std::size_t b) const {
  for (const PairVerdict& one : pairs) {
    if ((one.a == a && one.b == b) || (one.a == b && one.b == a)) return &one;
  }
  return nullptr;
}

Verdict Ranking::between(std::size_t a, std::size_t b) const {
  const PairVerdict* found = pair(a, b);
  if (!found) return Verdict::kUnknown;
  if (found->a == a) return found->verdict;
  if (found->verdict == Verdict::kBetter) return Verdict::kWorse;
  return found->verdict == Verdict::kWorse ? Verdict::kBetter : found->verdict;
}

Ranking rank_methods(const std::vector<Series>& methods, Better better,
                     const RankOptions& options) {
  Ranking ranking;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const bool left_out = m < options.left_out.size() && options.left_out[m];
    const bool compared = !left_out && methods[m].known() >= 2 && !methods[m].alike() &&
                          !methods[m].unbounded() && methods[m].withheld == Withheld::kNo;
    ranking.methods.push_back({m, mean_interval(methods[m], options.range), "", compared});
  }
  const bool logarithmic =
      better == Better::kLower && std::ranges::all_of(ranking.methods, [&](const auto& ranked) {
        return !ranked.compared || all_positive(methods[ranked.method].values);
      });
  std::ranges::stable_sort(ranking.methods, {}, [&](const RankedMethod& ranked) {
    return std::pair(!ranked.compared,
                     order_of(ranked, methods[ranked.method], better, logarithmic));
  });
  const auto compared =
      static_cast<std::size_t>(std::ranges::count(ranking.methods, true, &RankedMethod::compared));
  std::vector<double> p;
  std::vector<Comparison> comparisons;
  for (const auto& [i, j] : wanted_pairs(ranking, compared, options)) {
    const std::size_t a = ranking.methods[i].method, b = ranking.methods[j].method;
    PairVerdict& pair = ranking.pairs.emplace_back(
        PairVerdict{a, b, compare_paired(methods[a], methods[b], better, logarithmic), {}});
    const bool has_ratio = !logarithmic && compares_logarithms(methods[a], methods[b], better);
    pair.ratio = has_ratio ? compare_paired(methods[a], methods[b], better).ratio()
                           : pair.comparison.ratio();
    p.push_back(pair.comparison.p);
    comparisons.push_back(pair.comparison);
  }
  const std::size_t all = compared > options.most_paired ? compared * (compared - 1) / 2 : 0;
  const Family family = family_of(comparisons, p, all);
  for (std::size_t k = 0; k < p.size(); ++k) {
    PairVerdict& pair = ranking.pairs[k];
    pair.p = family.p[k];
    pair.factor = family.factors[k];
    pair.verdict = verdict_of(pair.comparison, pair.p, options.significance);
  }
  if (compared <= options.most_paired) set_letters(ranking, compared);
  return ranking;
}

}  // namespace spool
