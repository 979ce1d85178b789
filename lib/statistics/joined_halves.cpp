#include "lib/statistics/joined_halves.h"

#include <algorithm>
#include <utility>

namespace spool {
namespace {

// Mean and M2 of a piece of which both halves have samples.
void set_joined(double& mean, double& m2, double even, double odd, double factor) {
  mean = 0.5 * (even + odd);
  m2 *= factor;
}

}  // namespace

Selection join_halves(const SamplePool& pool, std::vector<Selection> halves) {
  SPOOL_CHECK_EQ(halves.size(), std::size_t{2});
  const PieceStatistics &even = halves[0].statistics, &odd = halves[1].statistics;
  CountImage n = even.n;
  for (std::size_t i = 0; i < n.size(); ++i)
    n[i] += odd.n[i];
  PieceStatistics all = prefix_statistics(pool.with_halves_first(even.n, odd.n), n, even.signal);
  for (std::size_t i = 0; i < n.size(); ++i) {
    const double a = even.n[i], b = odd.n[i];
    if (a == 0.0 || b == 0.0) continue;
    const double factor = (a + b) * (a + b) / (4.0 * a * b);
    for (std::size_t c = 0; c < 3; ++c)
      set_joined(all.mean[c][i], all.m2[c][i], even.mean[c][i], odd.mean[c][i], factor);
    set_joined(all.analysis.mean[i], all.analysis.m2[i], even.analysis.mean[i],
               odd.analysis.mean[i], factor);
  }
  return {std::move(all), {}, std::move(halves), HalvesUse::kTogether};
}

PieceStatistics half_statistics(const PieceStatistics& statistics, const SamplePool& half_pool,
                                int parity) {
  CountImage n = statistics.n;
  for (std::size_t i = 0; i < n.size(); ++i)
    n[i] = (n[i] + 1 - parity) / 2;
  return prefix_statistics(half_pool, n, statistics.signal, statistics.channel_minimum.has_value());
}

SamplePool pool_of_joined(const SamplePool& pool, const Selection& selection) {
  return pool.with_halves_first(selection.halves[0].statistics.n, selection.halves[1].statistics.n);
}

CountImage prefixes_over(const CountImage& even, const CountImage& odd) {
  CountImage prefix(even.width(), even.height());
  for (std::size_t i = 0; i < prefix.size(); ++i)
    prefix[i] = std::max(even[i] > 0 ? 2 * even[i] - 1 : 0, 2 * odd[i]);
  return prefix;
}

CountImage looked_at(const Selection& selection) {
  if (selection.halves_use == HalvesUse::kApart) return selection.statistics.n;
  return prefixes_over(selection.halves[0].statistics.n, selection.halves[1].statistics.n);
}

}  // namespace spool
