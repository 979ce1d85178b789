// Slow twin of lib/sampling/neyman.h: deviations from two passes over each piece's pool, and a
// search for the place of each sample.
#pragma once

#include <cmath>

#include "lib/sampling/sampler.h"

namespace spool::reference {

// weight(c, x, y): of a channel's variance in pixel (x, y).
template <class Weight>
Plane pool_deviation(const SamplePool& pool, Weight&& weight) {
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
          squares += weight(c, x, y) * difference * difference;
        }
      }
      deviation(x, y) = std::sqrt(squares / (3.0 * (count - 1)));
    }
  }
  return deviation;
}

// Counts for `budget` samples when every piece has `first` already: one sample after the other goes
// where it takes most off the sum of variance / count, the first of several.
template <class Weight>
CountImage neyman(const SamplePool& pool, const CountImage& first, long long budget,
                  Weight&& channel_weight) {
  const Plane deviation = pool_deviation(pool, channel_weight);
  CountImage n = first;
  for (long long left = budget - count_samples(first); left > 0; --left) {
    double largest = -1.0;
    std::size_t at = 0;
    for (std::size_t i = 0; i < n.size(); ++i) {
      const int x = static_cast<int>(i) % n.width(), y = static_cast<int>(i) / n.width();
      const double gain = deviation[i] * deviation[i] / (n[i] * (n[i] + 1.0));
      if (n[i] < pool.capacity(x, y) && gain > largest) largest = gain, at = i;
    }
    if (largest < 0.0) break;
    ++n[at];
  }
  return n;
}

inline CountImage neyman(const SamplePool& pool, const CountImage& first, long long budget) {
  return neyman(pool, first, budget, [](std::size_t, int, int) { return 1.0; });
}

// With u^2 / (u^2 D^2 + 0.01), D the mean of everything in the pool, u = 1 / its mean luminance.
inline CountImage neyman_relative(const SamplePool& pool, const CountImage& first,
                                  long long budget) {
  RgbImage mean = make_rgb(pool.width(), pool.height());
  double total = 0.0;
  for (int y = 0; y < pool.height(); ++y) {
    for (int x = 0; x < pool.width(); ++x) {
      for (int s = 0; s < pool.size(x, y); ++s) {
        for (std::size_t c = 0; c < 3; ++c)
          mean[c](x, y) += static_cast<double>(pool.sample(x, y, s)[c]) / pool.size(x, y);
      }
      total += 0.2126 * mean[0](x, y) + 0.7152 * mean[1](x, y) + 0.0722 * mean[2](x, y);
    }
  }
  const double u = pool.width() * pool.height() / total;
  return neyman(pool, first, budget, [&](std::size_t c, int x, int y) {
    const double d = u * mean[c](x, y);
    return u * u / (d * d + 0.01);
  });
}

}  // namespace spool::reference
