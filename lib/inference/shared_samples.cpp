#include "lib/inference/shared_samples.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "lib/core/check.h"
#include "lib/core/radical_inverse.h"

namespace spool {
namespace {

// Of two arcs of length `taken` on a ring of length 1 that start `apart` from each other.
double common_arc(double taken, double apart) {
  return std::max(0.0, taken - apart) + std::max(0.0, taken - (1.0 - apart));
}

double correlation_of(double share, double rare) {
  return rare * share + (1.0 - rare) * share * share;
}

Shared of_a_piece(double taken, double rare, const ReplicatePairs& pairs, Taking taking) {
  if (taking == Taking::kOwnOrder) return {taken, correlation_of(taken, rare)};
  Shared sum;
  const auto steps = static_cast<double>(pairs.apart.size());
  for (std::size_t i = 1; i < pairs.apart.size(); ++i) {
    if (pairs.apart[i] == 0) continue;
    const double share = common_arc(taken, static_cast<double>(i) / steps) / taken;
    const auto count = static_cast<double>(pairs.apart[i]);
    sum.samples += count * share;
    sum.correlation += count * correlation_of(share, rare);
  }
  const double all = 0.5 * pairs.replicates * (pairs.replicates - 1.0);
  return {sum.samples / all, sum.correlation / all};
}

}  // namespace

double rare_share(double kurtosis, double samples) {
  if (std::isnan(kurtosis)) return 1.0;
  SPOOL_CHECK_GT(samples, 0.0);
  const double of_the_mean = std::max(0.0, kurtosis) / samples;
  return std::isinf(of_the_mean) ? 1.0 : of_the_mean / (2.0 + of_the_mean);
}

ReplicatePairs pairs_of(int replicates) {
  SPOOL_CHECK_GE(replicates, 0);
  const std::size_t steps = std::bit_ceil(static_cast<std::size_t>(std::max(1, replicates)));
  std::vector<std::size_t> places;
  for (int r = 0; r < replicates; ++r) {  // exact: a multiple of 1 / steps
    const double share = radical_inverse(static_cast<unsigned>(r)) * static_cast<double>(steps);
    places.push_back(static_cast<std::size_t>(share));
  }
  std::ranges::sort(places);
  ReplicatePairs pairs{replicates, std::vector<long long>(steps, 0)};
  for (std::size_t a = 0; a < places.size(); ++a) {
    for (std::size_t b = a + 1; b < places.size(); ++b)
      ++pairs.apart[places[b] - places[a]];
  }
  return pairs;
}

Shared shared_by_replicates(const TakenSamples& taken, const ReplicatePairs& pairs, Taking taking) {
  SPOOL_CHECK_GT(taken.recorded, 0.0);
  Shared mean;
  if (pairs.replicates < 2) return mean;
  double all = 0.0;
  for (const auto& [count, pieces] : taken.counts) {
    if (count <= 0) continue;
    const auto weight = static_cast<double>(pieces);
    const Shared piece =
        of_a_piece(std::min(1.0, count / taken.recorded), taken.rare, pairs, taking);
    mean.samples += weight * piece.samples;
    mean.correlation += weight * piece.correlation;
    all += weight;
  }
  if (all > 0.0) {
    mean.samples /= all;
    mean.correlation /= all;
  }
  return mean;
}

double over_recordings(double shared, int replicates, int recordings) {
  const int all = replicates * recordings;
  return all > 1 ? shared * (replicates - 1) / (all - 1) : 0.0;
}

double shared_by_methods(const TakenSamples& a, const TakenSamples& b) {
  const double rare = std::max(a.rare, b.rare);
  double sum = 0.0, all = 0.0;
  std::size_t i = 0, j = 0;
  long long used_a = 0, used_b = 0;  // pieces of counts[i], counts[j] that have been matched
  while (i < a.counts.size() && j < b.counts.size()) {
    const auto& [of_a, pieces_a] = a.counts[i];
    const auto& [of_b, pieces_b] = b.counts[j];
    const long long matched = std::min(pieces_a - used_a, pieces_b - used_b);
    if (of_a > 0 && of_b > 0) {
      const double share = std::sqrt(static_cast<double>(std::min(of_a, of_b)) /
                                     static_cast<double>(std::max(of_a, of_b)));
      sum += static_cast<double>(matched) * correlation_of(share, rare);
      all += static_cast<double>(matched);
    }
    if ((used_a += matched) == pieces_a) ++i, used_a = 0;
    if ((used_b += matched) == pieces_b) ++j, used_b = 0;
  }
  return all > 0.0 ? sum / all : 1.0;
}

double shared_by_differences(double correlation, double same, double measured) {
  if (same >= 1.0 || !(measured > 0.0)) return correlation;
  const double common = std::min(measured, same);
  return correlation * (1.0 - common / same) / (1.0 - common);
}

}  // namespace spool
