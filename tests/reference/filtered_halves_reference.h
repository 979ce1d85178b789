// Slow twin of lib/sampling/filtered_halves.h for one piece per pixel.
#pragma once

#include <cmath>
#include <vector>

#include "lib/sampling/apportion.h"
#include "lib/sampling/filtered_halves.h"
#include "tests/reference/blur_reference.h"

namespace spool::reference {

// Weights of the next round: sqrt of the smoothed relative difference of the filtered halves.
inline Plane halves_weight(const SamplePool& pool, const CountImage& n, double exposure,
                           double sigma, const LoopFilter& filter) {
  RgbImage image[2];
  for (int parity = 0; parity < 2; ++parity) {
    const SamplePool half_pool = pool.half(parity);
    Selection half;
    half.statistics = empty_statistics(half_pool);
    for (int y = 0; y < n.height(); ++y) {
      for (int x = 0; x < n.width(); ++x) {
        for (int s = parity; s < n(x, y); s += 2)
          take(half.statistics, half_pool, x, y);
      }
    }
    half.statistics.signal.exposure = exposure;
    image[parity] = *filter(half, half_pool);
  }
  Plane e(n.width(), n.height());
  for (std::size_t i = 0; i < e.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double a = exposure * image[0][c][i], b = exposure * image[1][c][i];
      const double f = (a + b) / 2;
      e[i] += (a - b) * (a - b) / (f * f + 0.01) / 3.0;
    }
  }
  e = blur_within(e, sigma, static_cast<int>(std::ceil(3 * sigma)));
  for (double& value : e.pixels())
    value = std::sqrt(value);
  return e;
}

// All rounds: counts after `left` more samples than `n`, in `rounds` shares.
inline CountImage filtered_halves(const SamplePool& pool, CountImage n, double exposure,
                                  long long left, int rounds, double sigma,
                                  const LoopFilter& filter) {
  for (int round = 0; round < rounds; ++round) {
    const long long share = left / rounds + (round < left % rounds ? 1 : 0);
    if (share == 0) continue;
    const Plane weight = halves_weight(pool, n, exposure, sigma, filter);
    double sum = 0.0;
    long long taken = 0;
    for (std::size_t i = 0; i < n.size(); ++i) {
      sum += weight[i];
      taken += n[i];
    }
    std::vector<double> deficit(n.size(), 0.0);
    std::vector<long long> room(n.size());
    for (int y = 0; y < n.height(); ++y) {
      for (int x = 0; x < n.width(); ++x) {
        const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(n.width()) +
                              static_cast<std::size_t>(x);
        room[i] = pool.capacity(x, y) - n(x, y);
        if (sum > 0.0) {
          const double worth = weight[i] / sum * static_cast<double>(taken + share);
          deficit[i] = worth > n[i] ? worth - n[i] : 0.0;
        }
      }
    }
    const std::vector<long long> extra = apportion(deficit, share, room);
    for (std::size_t i = 0; i < n.size(); ++i)
      n[i] += static_cast<int>(extra[i]);
  }
  return n;
}

}  // namespace spool::reference
