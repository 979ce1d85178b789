// Slow twin of the sample clamp: the limit of one pixel after the other, by the definition.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/core/extend.h"
#include "lib/core/image.h"
#include "lib/pool/sample_pool.h"

namespace spool::reference {

// Luminances of the samples taken of pixel (x, y), piece by piece.
inline std::vector<double> luminances(const SamplePool& pool, const CountImage& n, int x, int y) {
  const int q = pool.pieces_per_side();
  std::vector<double> values;
  for (int j = 0; j < q; ++j) {
    for (int i = 0; i < q; ++i) {
      for (int s = 0; s < n(x * q + i, y * q + j); ++s) {
        const Rgb v = pool.sample(x * q + i, y * q + j, s);
        values.push_back(0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2]);
      }
    }
  }
  return values;
}

// Mean luminance of the pixel means without the largest floor(1 %); 1 if not above 0.
inline double mean_without_brightest(const SamplePool& pool, const CountImage& n) {
  std::vector<double> means;
  const int q = pool.pieces_per_side();
  for (int y = 0; y < n.height() / q; ++y) {
    for (int x = 0; x < n.width() / q; ++x) {
      double sum = 0.0;
      for (int j = 0; j < q * q; ++j) {
        const int px = x * q + j % q, py = y * q + j / q;
        double piece = 0.0;
        for (int s = 0; s < n(px, py); ++s) {
          const Rgb v = pool.sample(px, py, s);
          piece += 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2];
        }
        sum += piece / n(px, py);
      }
      means.push_back(sum / (q * q));
    }
  }
  std::sort(means.begin(), means.end());
  means.resize(means.size() - means.size() / 100);
  double sum = 0.0;
  for (const double mean : means)
    sum += mean;
  return sum > 0.0 ? sum / static_cast<double>(means.size()) : 1.0;
}

inline Plane sample_limits(const SamplePool& pool, const CountImage& n, double kappa, double sigma,
                           double floor) {
  const int q = pool.pieces_per_side(), width = n.width() / q, height = n.height() / q;
  std::size_t groups = 4;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      groups = std::min(groups, luminances(pool, n, x, y).size());
  }
  std::vector<Plane> mean(groups, Plane(width, height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::vector<double> values = luminances(pool, n, x, y);
      for (std::size_t k = 0; k < groups; ++k) {
        double sum = 0.0;
        int count = 0;
        for (std::size_t s = k; s < values.size(); s += groups, ++count)
          sum += values[s];
        mean[k](x, y) = sum / count;
      }
    }
  }
  const double unit = mean_without_brightest(pool, n);
  const int radius = static_cast<int>(4.0 * sigma + 0.5);
  Plane limits(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::vector<double> around;
      for (std::size_t k = 0; k < groups; ++k) {
        double sum = 0.0, weights = 0.0;
        for (int dy = -radius; dy <= radius; ++dy) {
          for (int dx = -radius; dx <= radius; ++dx) {
            const double w = std::exp(-(dx * dx + dy * dy) / (2.0 * sigma * sigma));
            sum += w * mean[k](extend_symmetric(x + dx, width), extend_symmetric(y + dy, height));
            weights += w;
          }
        }
        around.push_back(sum / weights);
      }
      std::sort(around.begin(), around.end());
      const double median = 0.5 * (around[(groups - 1) / 2] + around[groups / 2]);
      std::vector<double> values = luminances(pool, n, x, y);
      std::sort(values.begin(), values.end());
      double own = 0.0;
      for (std::size_t s = 0; s + 1 < values.size(); ++s)
        own += values[s] / static_cast<double>(values.size() - 1);
      limits(x, y) =
          std::max(kappa, static_cast<double>(values.size())) * std::max({median, own, 0.0}) +
          floor * unit;
    }
  }
  return limits;
}

}  // namespace spool::reference
