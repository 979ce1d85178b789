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

double shared_on_a_ring(double taken, int replicates) {
  double sum = 0.0;
  for (int r = 0; r < replicates; ++r) {
    for (int s = 0; s < r; ++s) {
      const double apart = std::abs(radical_inverse(static_cast<unsigned>(r)) -
                                    radical_inverse(static_cast<unsigned>(s)));
      sum += common_arc(taken, apart);
    }
  }
  return sum / (0.5 * replicates * (replicates - 1.0)) / taken;
}

}  // namespace

double shared_share(std::span<const std::pair<int, long long>> counts, double recorded,
                    int replicates, Taking taking) {
  SPOOL_CHECK_GT(recorded, 0.0);
  if (replicates < 2) return 0.0;
  double shared = 0.0, all = 0.0;
  for (const auto& [count, pixels] : counts) {
    if (count <= 0) continue;
    const auto weight = static_cast<double>(pixels);
    const double taken = std::min(1.0, count / recorded);
    shared += weight * (taking == Taking::kOwnOrder ? taken : shared_on_a_ring(taken, replicates));
    all += weight;
  }
  return all > 0.0 ? shared / all : 0.0;
}

double over_recordings(double shared, int replicates, int recordings) {
  const int all = replicates * recordings;
  return all > 1 ? shared * (replicates - 1) / (all - 1) : 0.0;
}

}  // namespace spool
