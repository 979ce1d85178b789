#include "lib/statistics/variance_of_mean.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "lib/core/pairwise_sum.h"
#include "lib/core/parallel.h"
#include "lib/statistics/window_sums.h"

namespace spool {
namespace {

constexpr int kSmallestRadius = 2;

// Pooled sample variance of the 5x5 window around (x, y); negative when no piece in it has two
// samples.
double window_variance(const CountImage& n, const Plane& m2, int x, int y) {
  const int radius = kSmallestRadius;
  const Rectangle window =
      intersect({x - radius, y - radius, x + radius + 1, y + radius + 1}, n.bounds());
  double squares = 0.0, freedom = 0.0;
  for (int py = window.y0; py < window.y1; ++py) {
    for (int px = window.x0; px < window.x1; ++px) {
      if (n(px, py) < 2) continue;
      squares += m2(px, py);
      freedom += n(px, py) - 1;
    }
  }
  return freedom > 0.0 ? squares / freedom : -1.0;
}

// Whether the variance of a piece with n samples is pooled with that of its neighbours.
bool is_pooled(int n, VarianceMode mode) {
  return n > 0 && (mode == VarianceMode::kPooled || (mode == VarianceMode::kAuto && n < 4));
}

// Pooled sample variance around every piece that needs it, 0 elsewhere; some piece has two samples.
// Windows larger than 5x5 are summed for the whole image at once: where most pieces have one sample
// they may have to grow over all of it.
Plane pooled_variances(const CountImage& n, const Plane& m2, VarianceMode mode) {
  Plane pooled(n.width(), n.height());
  parallel_rows(0, n.height(), [&](int y) {
    for (int x = 0; x < n.width(); ++x)
      pooled(x, y) = is_pooled(n(x, y), mode) ? window_variance(n, m2, x, y) : 0.0;
  });
  const auto missing = [&] {
    return std::any_of(pooled.pixels().begin(), pooled.pixels().end(),
                       [](double value) { return value < 0.0; });
  };
  for (int radius = 2 * kSmallestRadius; missing(); radius *= 2) {
    Plane squares(n.width(), n.height()), freedom(n.width(), n.height());
    parallel_rows(0, n.height(), [&](int y) {
      for (std::size_t i = n.index(0, y); i < n.index(0, y + 1); ++i) {
        squares[i] = n[i] < 2 ? 0.0 : m2[i];
        freedom[i] = n[i] < 2 ? 0.0 : n[i] - 1;
      }
    });
    squares = window_sums(std::move(squares), radius);
    freedom = window_sums(std::move(freedom), radius);
    parallel_rows(0, n.height(), [&](int y) {
      for (std::size_t i = n.index(0, y); i < n.index(0, y + 1); ++i) {
        if (pooled[i] < 0.0 && freedom[i] > 0.0) pooled[i] = squares[i] / freedom[i];
      }
    });
  }
  return pooled;
}

// Half the mean squared difference of neighbouring means: the variance of a piece's mean when the
// image is flat. Used only where every n <= 1, so a mean is one sample.
double neighbour_variance(const CountImage& n, const Plane& mean) {
  const int width = mean.width(), height = mean.height();
  const auto pair = [&](std::size_t i, std::size_t j, double& sum, double& count) {
    if (n[i] == 0 || n[j] == 0) return;
    const double difference = mean[i] - mean[j];
    sum += difference * difference;
    count += 1.0;
  };
  std::vector<double> sums(static_cast<std::size_t>(height), 0.0), counts(sums.size(), 0.0);
  parallel_rows(0, height, [&](int y) {
    double sum = 0.0, count = 0.0;
    for (int x = 0; x < width; ++x) {
      if (x + 1 < width) pair(mean.index(x, y), mean.index(x + 1, y), sum, count);
      if (y + 1 < height) pair(mean.index(x, y), mean.index(x, y + 1), sum, count);
    }
    sums[static_cast<std::size_t>(y)] = sum;
    counts[static_cast<std::size_t>(y)] = count;
  });
  const double pairs = pairwise_sum(counts.size(), [&](std::size_t i) { return counts[i]; });
  if (pairs == 0.0) return 0.0;
  return 0.5 * pairwise_sum(sums.size(), [&](std::size_t i) { return sums[i]; }) / pairs;
}

}  // namespace

double variance_floor(double mean, double scale) {
  const double deviation = 1e-6 * (std::abs(mean) + 1e-3 * scale);
  return deviation * deviation;
}

Plane variance_of_mean(const CountImage& n, const Plane& mean, const Plane& m2,
                       const VarianceOptions& options, GuardCounts& guards) {
  SPOOL_CHECK(n.same_size(mean));
  SPOOL_CHECK(n.same_size(m2));
  const bool any_pair =
      std::any_of(n.pixels().begin(), n.pixels().end(), [](std::int32_t k) { return k >= 2; });
  const double flat_variance =
      any_pair || options.mode == VarianceMode::kRaw ? 0.0 : neighbour_variance(n, mean);
  // First the variance around a piece, then its own.
  Plane v = any_pair && options.mode != VarianceMode::kRaw
                ? pooled_variances(n, m2, options.mode)
                : Plane(n.width(), n.height(), flat_variance);
  std::vector<GuardCounts> rows(static_cast<std::size_t>(n.height()));
  parallel_rows(0, n.height(), [&](int y) {
    for (int x = 0; x < n.width(); ++x) {
      const int count = n(x, y);
      if (count == 0) {
        v(x, y) = std::numeric_limits<double>::infinity();
        continue;
      }
      double value = 0.0;
      if (is_pooled(count, options.mode)) {
        const double own = count >= 2 ? m2(x, y) : 0.0;
        const int freedom = count - 1;
        value = (own + kNu0 * v(x, y)) / (freedom + kNu0) / count;
      } else if (count >= 2) {
        value = m2(x, y) / (count - 1) / count;
      }
      const double floor = variance_floor(mean(x, y), options.scale);
      if (!(value >= floor)) {
        rows[static_cast<std::size_t>(y)].add(Guard::kVarianceFloor);
        value = floor;
      }
      v(x, y) = value;
    }
  });
  for (const GuardCounts& row : rows)
    guards += row;
  return v;
}

Plane analysis_variance(const PieceStatistics& statistics, const VarianceOptions& options,
                        GuardCounts& guards) {
  return variance_of_mean(statistics.n, statistics.analysis.mean, statistics.analysis.m2, options,
                          guards);
}

}  // namespace spool
