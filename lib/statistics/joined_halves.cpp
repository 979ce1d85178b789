#include "lib/statistics/joined_halves.h"

#include <algorithm>
#include <array>
#include <utility>

#include "lib/core/parallel.h"

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

int half_of_joined(int even, int odd, int i) {
  const int longer = even > odd ? 0 : 1;
  return i < 2 * std::min(even, odd) ? i % 2 : longer;
}

void weigh_halves_alike(PieceStatistics& all, const SamplePool& joined, const CountImage& even,
                        const CountImage& odd) {
  parallel_rows(0, all.height(), [&](int y) {
    for (int x = 0; x < all.width(); ++x) {
      const std::size_t piece = even.index(x, y);
      const std::array<int, 2> n = {even[piece], odd[piece]};
      if (n[0] == 0 || n[1] == 0) continue;
      std::array<std::array<double, 4>, 2> mean{};  // [half]: R, G, B and the analysis signal
      for (int i = 0; i < n[0] + n[1]; ++i) {
        const auto h = static_cast<std::size_t>(half_of_joined(n[0], n[1], i));
        const Rgb value = joined.sample(x, y, i);
        for (std::size_t c = 0; c < 3; ++c)
          mean[h][c] += static_cast<double>(value[c]) / n[h];
        mean[h][3] += all.signal.value(value) / n[h];
      }
      const double a = n[0], b = n[1], factor = (a + b) * (a + b) / (4.0 * a * b);
      for (std::size_t c = 0; c < 3; ++c)
        set_joined(all.mean[c][piece], all.m2[c][piece], mean[0][c], mean[1][c], factor);
      set_joined(all.analysis.mean[piece], all.analysis.m2[piece], mean[0][3], mean[1][3], factor);
    }
  });
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
