// Slow twin of lib/sampling/mitchell.h: reads every taken sample again and moves one sample at a
// time.
#pragma once

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "lib/sampling/mitchell.h"

namespace spool::reference {

// ratio of piece (x, y), from all samples taken in its window.
inline double mitchell_ratio(const SamplePool& pool, const CountImage& n, int x, int y,
                             double exposure, const std::vector<double>& tau, int window) {
  double ratio = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    double low = 1e300, high = -1e300;
    for (int v = y - window / 2; v <= y + window / 2; ++v) {
      for (int u = x - window / 2; u <= x + window / 2; ++u) {
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
                           const std::vector<double>& tau, const MitchellOptions& o) {
  const bool rounds = o.mode == MitchellMode::kMultiRound;
  for (int round = 0; round < (rounds ? o.rounds : 1); ++round) {
    long long share = rounds ? left / o.rounds + (round < left % o.rounds ? 1 : 0) : left;
    using Rank = std::tuple<bool, int, double, int, int>;  // flagged first, n, -ratio, y, x
    std::vector<Rank> ranks;
    for (int y = 0; y < n.height(); ++y) {
      for (int x = 0; x < n.width(); ++x) {
        const double ratio = mitchell_ratio(pool, n, x, y, exposure, tau, o.window);
        const bool flagged = ratio > 1.0;
        if (o.mode == MitchellMode::kTwoLevel && !flagged) continue;
        if (rounds) {
          ranks.push_back({!flagged, flagged ? n(x, y) : 0, -ratio, y, x});
        } else {
          ranks.push_back({false, 0, -ratio, y, x});
        }
      }
    }
    std::sort(ranks.begin(), ranks.end());
    int most = rounds ? o.per : std::max(o.n_high - o.n_base, 1);
    if (o.mode == MitchellMode::kTwoLevelBudget) {
      while (static_cast<long long>(most) * static_cast<long long>(n.size()) < share)
        ++most;
    }
    bool any = true;
    while (share > 0 && any) {
      any = false;
      for (const auto& [unflagged, count, ratio, y, x] : ranks) {
        for (int i = 0; i < most && share > 0 && n(x, y) < pool.capacity(x, y); ++i) {
          ++n(x, y);
          --share;
          any = true;
        }
      }
      if (o.mode == MitchellMode::kTwoLevel) break;
    }
  }
  return n;
}

}  // namespace spool::reference
