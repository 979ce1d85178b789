// Slow twin of lib/sampling/neyman.h: deviations from two passes over each piece's pool.
#pragma once

#include <cmath>
#include <vector>

#include "lib/sampling/apportion.h"
#include "lib/sampling/sampler.h"

namespace spool::reference {

inline Plane pool_deviation(const SamplePool& pool) {
  Plane deviation(pool.width(), pool.height());
  for (int y = 0; y < pool.height(); ++y) {
    for (int x = 0; x < pool.width(); ++x) {
      const int count = pool.size(x, y);
      if (count < 2) continue;
      double squares = 0.0;
      for (std::size_t c = 0; c < 3; ++c) {
        double mean = 0.0;
        for (int s = 0; s < count; ++s)
          mean += static_cast<double>(pool.sample(x, y, s)[c]) / count;
        for (int s = 0; s < count; ++s) {
          const double difference = pool.sample(x, y, s)[c] - mean;
          squares += difference * difference;
        }
      }
      deviation(x, y) = std::sqrt(squares / (3.0 * (count - 1)));
    }
  }
  return deviation;
}

// Counts for `budget` samples when every piece has `first` already: what each lacks of its ideal.
inline CountImage neyman(const SamplePool& pool, const CountImage& first, long long budget) {
  const Plane deviation = pool_deviation(pool);
  std::vector<double> weight(deviation.pixels().begin(), deviation.pixels().end());
  std::vector<long long> room;
  long long initial = 0, capacity = 0;
  for (int y = 0; y < pool.height(); ++y) {
    for (int x = 0; x < pool.width(); ++x) {
      room.push_back(pool.capacity(x, y));
      capacity += pool.capacity(x, y);
    }
  }
  const std::vector<long long> ideal = apportion(weight, budget, room);
  for (std::size_t i = 0; i < weight.size(); ++i) {
    weight[i] = ideal[i] > first[i] ? static_cast<double>(ideal[i] - first[i]) : 0.0;
    room[i] -= first[i];
    initial += first[i];
  }
  const std::vector<long long> extra =
      apportion(weight, std::min(budget, capacity) - initial, room);
  CountImage n = first;
  for (std::size_t i = 0; i < weight.size(); ++i)
    n[i] += static_cast<int>(extra[i]);
  return n;
}

}  // namespace spool::reference
