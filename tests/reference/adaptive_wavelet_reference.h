// Slow twin of lib/sampling/adaptive_wavelet.h: every coefficient as a sum over the block's pieces.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/core/extend.h"
#include "lib/sampling/adaptive_wavelet.h"
#include "lib/sampling/priority_maxima.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool::reference {

// Counts after `left` more samples, one per piece of each block popped.
inline CountImage adaptive_wavelet(const SamplePool& pool, CountImage n,
                                   const AnalysisSignal& signal, long long left,
                                   const AdaptiveWaveletOptions& o,
                                   std::vector<long long>& samples_of_level) {
  const int width = n.width(), height = n.height();
  samples_of_level.assign(static_cast<std::size_t>(o.levels) + 1, 0);
  const long long share = (left + o.epochs - 1) / o.epochs;
  while (left > 0) {
    GuardCounts guards;
    const PieceStatistics statistics = prefix_statistics(pool, n, signal);
    const Plane v = analysis_variance(statistics, {}, guards);
    std::vector<RegionEntry> entries;
    for (int k = 0; k <= o.levels; ++k) {
      const int side = 1 << k;
      for (int by = 0; by * side < height; ++by) {
        for (int bx = 0; bx * side < width; ++bx) {
          double s = 0.0, h = 0.0, w = 0.0, d = 0.0, variance = 0.0;
          for (int j = 0; j < side; ++j) {
            for (int i = 0; i < side; ++i) {
              const int x = extend_symmetric(bx * side + i, width);
              const int y = extend_symmetric(by * side + j, height);
              const double m = statistics.analysis.mean(x, y) / side;  // basis functions are 2^-k
              const int left_half = 2 * i < side ? 1 : -1, top_half = 2 * j < side ? 1 : -1;
              s += m;
              h += left_half * m;
              w += top_half * m;
              d += left_half * top_half * m;
              if (v(x, y) > variance_floor(statistics.analysis.mean(x, y))) {
                variance += v(x, y) / (side * side);
              }
            }
          }
          const double area = side * side, mean = s / side;
          const double above =
              k == 0 ? 0.0 : std::max(0.0, h * h + w * w + d * d - 4.0 * variance) / area;
          double p = variance + above;
          if (o.priority == WaveletPriority::kRelative) p /= mean * mean + 0.01;
          entries.push_back({k, bx, by, p});
        }
      }
    }
    std::sort(entries.begin(), entries.end(), precedes);
    CountImage extra(width, height), taken(width, height);
    long long chosen = 0;
    for (const RegionEntry& e : entries) {
      if (chosen >= std::min(share, left)) break;
      const int side = 1 << e.level;
      bool free = true;
      std::vector<std::vector<int>> open;  // n, y, x
      for (int y = e.y * side; y < std::min((e.y + 1) * side, height); ++y) {
        for (int x = e.x * side; x < std::min((e.x + 1) * side, width); ++x) {
          free = free && !taken(x, y);
          if (n(x, y) < pool.capacity(x, y)) open.push_back({n(x, y), y, x});
        }
      }
      if (!free || open.empty()) continue;
      std::sort(open.begin(), open.end());
      for (const auto& piece : open) {
        if (chosen == left) break;
        extra(piece[2], piece[1]) = 1;
        ++chosen;
        ++samples_of_level[static_cast<std::size_t>(e.level)];
      }
      for (int y = e.y * side; y < std::min((e.y + 1) * side, height); ++y) {
        for (int x = e.x * side; x < std::min((e.x + 1) * side, width); ++x)
          taken(x, y) = 1;
      }
    }
    for (std::size_t i = 0; i < n.size(); ++i)
      n[i] += extra[i];
    left -= chosen;
  }
  return n;
}

}  // namespace spool::reference
