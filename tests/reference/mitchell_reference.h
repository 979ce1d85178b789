// Slow twin of lib/sampling/mitchell.h: reads every taken sample again and moves one sample at a
// time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <vector>

#include "lib/sampling/mitchell.h"

namespace spool::reference {

// ratio of piece (x, y), from all samples taken in its window.
inline double mitchell_ratio(const SamplePool& pool, const CountImage& n, int x, int y,
                             double exposure, const std::array<double, 3>& tau) {
  double ratio = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    double low = 1e300, high = -1e300;
    for (int v = y - 1; v <= y + 1; ++v) {
      for (int u = x - 1; u <= x + 1; ++u) {
        if (u < 0 || v < 0 || u >= n.width() || v >= n.height()) continue;
        for (int s = 0; s < n(u, v); ++s) {
          low = std::min(low, exposure * pool.sample(u, v, s)[c]);
          high = std::max(high, exposure * pool.sample(u, v, s)[c]);
        }
      }
    }
    ratio = std::max(ratio, (high - low) / (std::abs(high) + std::abs(low) + 1e-4) / tau[c]);
  }
  return ratio;
}

// Counts, given those after the first samples and the exposure.
inline CountImage mitchell(const SamplePool& pool, CountImage n, double exposure, long long left,
                           const std::array<double, 3>& tau, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    long long share = left / rounds + (round < left % rounds ? 1 : 0);
    using Rank = std::tuple<bool, int, double, int, int>;  // flagged first, n, -ratio, y, x
    std::vector<Rank> ranks;
    for (int y = 0; y < n.height(); ++y) {
      for (int x = 0; x < n.width(); ++x) {
        const double ratio = mitchell_ratio(pool, n, x, y, exposure, tau);
        const bool flagged = ratio > 1.0;
        ranks.push_back({!flagged, flagged ? n(x, y) : 0, -ratio, y, x});
      }
    }
    std::sort(ranks.begin(), ranks.end());
    bool any = true;
    while (share > 0 && any) {
      any = false;
      for (const auto& [unflagged, count, ratio, y, x] : ranks) {
        for (int i = 0; i < 4 && share > 0 && n(x, y) < pool.capacity(x, y); ++i) {
          ++n(x, y);
          --share;
          any = true;
        }
      }
    }
  }
  return n;
}

}  // namespace spool::reference
