// Slow twin of lib/sampling/cross_halves.h for one piece per pixel.
#pragma once

#include <array>
#include <vector>

#include "tests/reference/filtered_halves_reference.h"

namespace spool::reference {

// Counts of both halves after `left[h]` more samples than `n[h]`, in `rounds` shares.
inline std::array<CountImage, 2> cross_halves(const SamplePool& pool, std::array<CountImage, 2> n,
                                              const std::array<double, 2>& exposure,
                                              const std::array<long long, 2>& left, int rounds,
                                              double sigma, const LoopFilter& filter) {
  for (int round = 0; round < rounds; ++round) {
    std::array<CountImage, 2> next = n;
    for (int h = 0; h < 2; ++h) {
      const int o = 1 - h;  // who decides
      const long long share = left[h] / rounds + (round < left[h] % rounds ? 1 : 0);
      if (share == 0) continue;
      const Plane weight = halves_weight(pool.half(o), n[o], exposure[o], sigma, filter);
      double sum = 0.0;
      long long taken = 0;
      for (std::size_t i = 0; i < n[h].size(); ++i) {
        sum += weight[i];
        taken += n[h][i];
      }
      std::vector<double> deficit(n[h].size(), 0.0);
      std::vector<long long> room(n[h].size());
      for (int y = 0; y < n[h].height(); ++y) {
        for (int x = 0; x < n[h].width(); ++x) {
          const std::size_t i = n[h].index(x, y);
          room[i] = pool.half(h).capacity(x, y) - n[h](x, y);
          const double worth =
              sum > 0.0 ? weight[i] / sum * static_cast<double>(taken + share) : 0.0;
          deficit[i] = worth > n[h][i] ? worth - n[h][i] : 0.0;
        }
      }
      const std::vector<long long> extra = apportion(deficit, share, room);
      for (std::size_t i = 0; i < n[h].size(); ++i)
        next[h][i] += static_cast<int>(extra[i]);
    }
    n = next;
  }
  return n;
}

}  // namespace spool::reference
