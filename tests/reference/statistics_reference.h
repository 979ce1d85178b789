// Slow twins of lib/statistics: two-pass sums in long double, by the definitions.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "lib/statistics/variance_of_mean.h"

namespace spool::reference {

struct ScalarSummary {
  double mean = 0, m2 = 0;
  double minimum = std::numeric_limits<double>::infinity();
  double maximum = -std::numeric_limits<double>::infinity();
};

inline ScalarSummary summary(const std::vector<double>& values) {
  ScalarSummary s;
  if (values.empty()) return s;
  long double sum = 0;
  for (const double v : values)
    sum += v;
  const long double mean = sum / static_cast<long double>(values.size());
  long double m2 = 0;
  for (const double v : values) {
    m2 += (v - mean) * (v - mean);
    s.minimum = std::min(s.minimum, v);
    s.maximum = std::max(s.maximum, v);
  }
  s.mean = static_cast<double>(mean);
  s.m2 = static_cast<double>(m2);
  return s;
}

// Pooled sample variance of the smallest window of 5, 9, 17, ... pieces around (x, y) in which a
// piece has two samples; half the mean squared difference of neighbours when none has.
inline double pooled_variance(const CountImage& n, const Plane& mean, const Plane& m2, int x,
                              int y) {
  const int width = n.width(), height = n.height();
  for (int radius = 2; radius <= 2 * std::max(width, height) + 2; radius *= 2) {
    long double squares = 0, freedom = 0;
    for (int py = y - radius; py <= y + radius; ++py) {
      for (int px = x - radius; px <= x + radius; ++px) {
        if (px < 0 || py < 0 || px >= width || py >= height || n(px, py) < 2) continue;
        squares += m2(px, py);
        freedom += n(px, py) - 1;
      }
    }
    if (freedom > 0) return static_cast<double>(squares / freedom);
  }
  long double sum = 0, pairs = 0;
  const auto add = [&](int ax, int ay, int bx, int by) {
    if (bx >= width || by >= height || n(ax, ay) == 0 || n(bx, by) == 0) return;
    sum += (mean(ax, ay) - mean(bx, by)) * (mean(ax, ay) - mean(bx, by));
    ++pairs;
  };
  for (int py = 0; py < height; ++py) {
    for (int px = 0; px < width; ++px) {
      add(px, py, px + 1, py);
      add(px, py, px, py + 1);
    }
  }
  return pairs == 0 ? 0.0 : static_cast<double>(sum / pairs / 2);
}

inline double variance_of_mean_at(const CountImage& n, const Plane& mean, const Plane& m2,
                                  const VarianceOptions& options, int x, int y) {
  const int count = n(x, y);
  if (count == 0) return std::numeric_limits<double>::infinity();
  const bool pooled =
      options.mode == VarianceMode::kPooled || (options.mode == VarianceMode::kAuto && count < 4);
  double v = 0;
  if (pooled) {
    const double shared = pooled_variance(n, mean, m2, x, y);
    v = (m2(x, y) + kNu0 * shared) / (std::max(count - 1, 0) + kNu0) / count;
  } else if (count > 1) {
    v = m2(x, y) / (count - 1) / count;
  }
  const double floor = 1e-6 * (std::abs(mean(x, y)) + 1e-3 * options.scale);
  return std::max(v, floor * floor);
}

// 1 / mean of the values left after the largest 1 % are dropped.
inline double exposure(const Plane& values, const CountImage& n) {
  std::vector<double> taken;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (n[i] > 0) taken.push_back(values[i]);
  }
  std::sort(taken.begin(), taken.end());
  const std::size_t kept = taken.size() - taken.size() / 100;
  long double sum = 0;
  for (std::size_t i = 0; i < kept; ++i)
    sum += taken[i];
  const double mean = kept > 0 ? static_cast<double>(sum / static_cast<long double>(kept)) : 0.0;
  return std::isfinite(mean) && mean >= 0x1p-126 ? 1.0 / mean : 1.0;
}

// Value of the nearest piece with n > 0: smallest ring, then smallest distance, then lowest index.
inline double nearest_value(const Plane& pieces, const CountImage& n, int x, int y) {
  double best = std::numeric_limits<double>::quiet_NaN();
  std::pair<int, int> best_key{1 << 30, 1 << 30};
  for (int py = 0; py < n.height(); ++py) {
    for (int px = 0; px < n.width(); ++px) {
      if (n(px, py) == 0) continue;
      const int dx = px - x, dy = py - y;
      const std::pair<int, int> key{std::max(std::abs(dx), std::abs(dy)), dx * dx + dy * dy};
      if (key < best_key) best_key = key, best = pieces(px, py);
    }
  }
  return best;
}

}  // namespace spool::reference
