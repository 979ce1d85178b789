// Slow twin of lib/filters/welch: everything in double, every pair on its own.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "lib/kernels/pair_filter.h"
#include "lib/statistics/transformed_moments.h"

namespace spool::reference {

// Two passes.
inline TransformedMoments transformed_moments(const SamplePool& pool, const CountImage& n,
                                              double unit, double lambda) {
  const auto zeros = [&] { return make_rgb(n.width(), n.height()); };
  TransformedMoments moments{zeros(), zeros(), zeros(), zeros()};
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        std::vector<double> values;
        for (int i = 0; i < n(x, y); ++i) {
          const double v = unit * static_cast<double>(pool.sample(x, y, i)[c]);
          values.push_back(lambda == 1.0 ? v : (std::pow(std::max(v, 0.0), lambda) - 1) / lambda);
        }
        double sum = 0.0;
        for (const double v : values)
          sum += v;
        const double mean = values.empty() ? 0.0 : sum / static_cast<double>(values.size());
        moments.mean[c](x, y) = mean;
        for (const double v : values) {
          moments.m2[c](x, y) += (v - mean) * (v - mean);
          moments.m3[c](x, y) += (v - mean) * (v - mean) * (v - mean);
          moments.m4[c](x, y) += std::pow(v - mean, 4);
        }
      }
    }
  }
  return moments;
}

// Does q = (u, v) serve p = (x, y)?
inline bool serves(const PairTest& test, int x, int y, int u, int v) {
  for (std::size_t k = 0; k < test.mean.size(); ++k) {
    const double d =
        static_cast<double>(test.mean[k](x, y)) - static_cast<double>(test.mean[k](u, v));
    const auto own = static_cast<double>(test.half2[k](x, y));
    const auto other = static_cast<double>(test.half2[k](u, v));
    if (d * d > own + std::min(test.kappa * own, other)) return false;
  }
  return true;
}

inline PairMeans pair_filter(const std::vector<const Plane*>& values, const PairTest& test,
                             const PairFeatures& features, const Image<float>& count,
                             const PairWindow& window) {
  const auto zeros = [&] { return Plane(count.width(), count.height()); };
  PairMeans means{std::vector<Plane>(values.size(), zeros()), zeros(), zeros()};
  const int r = window.radius;
  for (int y = 0; y < count.height(); ++y) {
    for (int x = 0; x < count.width(); ++x) {
      for (int v = std::max(0, y - r); v <= std::min(count.height() - 1, y + r); ++v) {
        for (int u = std::max(0, x - r); u <= std::min(count.width() - 1, x + r); ++u) {
          const int d2 = (u - x) * (u - x) + (v - y) * (v - y);
          if (d2 > r * r) continue;
          if (d2 > 0 && !serves(test, x, y, u, v)) continue;
          double e = d2 / (2 * window.sigma * window.sigma);
          for (std::size_t f = 0; d2 > 0 && f < features.value.size(); ++f) {
            const double d = static_cast<double>(features.value[f](x, y)) -
                             static_cast<double>(features.value[f](u, v));
            const double noise = static_cast<double>(features.variance[f](x, y)) +
                                 static_cast<double>(features.variance[f](u, v));
            e += std::max(0.0, d * d - noise) / (1 + 2 * noise);
          }
          const double w = static_cast<double>(count(u, v)) * std::exp(-e);
          means.weight(x, y) += w;
          means.weight2(x, y) += w * w;
          for (std::size_t i = 0; i < values.size(); ++i)
            means.value[i](x, y) += w * (*values[i])(u, v);
        }
      }
      for (Plane& value : means.value)
        value(x, y) = means.weight(x, y) > 0.0 ? value(x, y) / means.weight(x, y) : 0.0;
    }
  }
  return means;
}

}  // namespace spool::reference
