#include "lib/inference/shared_samples.h"

#include <algorithm>
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

Shared of_a_piece(double taken, double rare, int replicates, Taking taking) {
  if (taking == Taking::kOwnOrder) return {taken, correlation_of(taken, rare)};
  Shared sum;
  for (int r = 0; r < replicates; ++r) {
    for (int s = 0; s < r; ++s) {
      const double apart = std::abs(radical_inverse(static_cast<unsigned>(r)) -
                                    radical_inverse(static_cast<unsigned>(s)));
      const double share = common_arc(taken, apart) / taken;
      sum.samples += share;
      sum.correlation += correlation_of(share, rare);
    }
  }
  const double pairs = 0.5 * replicates * (replicates - 1.0);
  return {sum.samples / pairs, sum.correlation / pairs};
}

}  // namespace

double rare_share(double kurtosis, double samples) {
  if (std::isnan(kurtosis)) return 1.0;
  SPOOL_CHECK_GT(samples, 0.0);
  const double of_the_mean = std::max(0.0, kurtosis) / samples;
  return std::isinf(of_the_mean) ? 1.0 : of_the_mean / (2.0 + of_the_mean);
}

Shared shared_by_replicates(const TakenSamples& taken, int replicates, Taking taking) {
  SPOOL_CHECK_GT(taken.recorded, 0.0);
  Shared mean;
  if (replicates < 2) return mean;
  double all = 0.0;
  for (const auto& [count, pieces] : taken.counts) {
    if (count <= 0) continue;
    const auto weight = static_cast<double>(pieces);
    const Shared piece =
        of_a_piece(std::min(1.0, count / taken.recorded), taken.rare, replicates, taking);
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
