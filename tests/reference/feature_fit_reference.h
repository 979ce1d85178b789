// Slow twin of lib/filters/twin_guides/feature_fit.h: double, every sum as it is written there.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lib/core/image.h"

namespace spool::reference {

struct FeatureFitSettings {
  double tau, slack, gain;
  int patch, radius;
  double sigma, ridge;
};

struct FittedFeatures {
  std::vector<Plane> mean, variance;
};

// e(p, q), q = p + (dx, dy).
inline double feature_fit_distance(const std::vector<Plane>& f, const std::vector<Plane>& v,
                                   const FeatureFitSettings& s, int x, int y, int dx, int dy) {
  const int width = f[0].width(), height = f[0].height();
  double sum = 0.0;
  int pairs = 0;
  for (int py = std::max(y - s.patch, 0); py <= std::min(y + s.patch, height - 1); ++py) {
    for (int px = std::max(x - s.patch, 0); px <= std::min(x + s.patch, width - 1); ++px, ++pairs) {
      const int qx = std::clamp(px + dx, 0, width - 1), qy = std::clamp(py + dy, 0, height - 1);
      for (std::size_t c = 0; c < f.size(); ++c) {
        const double d = f[c](px, py) - f[c](qx, qy), vp = v[c](px, py), vq = v[c](qx, qy);
        sum += (d * d - s.slack * (vp + std::min(vp, vq))) / (vp + vq + s.tau);
      }
    }
  }
  return std::max(0.0, s.gain * sum / (pairs * static_cast<double>(f.size())));
}

// Coefficient 0 of the fit of the values on (1, dx, dy), by Cramer's rule.
inline double constant_of_line(const std::vector<std::array<double, 4>>& points, double ridge) {
  double a[3][3] = {}, b[3] = {};
  for (const auto& [w, dx, dy, value] : points) {
    const double u[3] = {1.0, dx, dy};
    for (int i = 0; i < 3; ++i) {
      b[i] += w * u[i] * value;
      for (int j = 0; j < 3; ++j)
        a[i][j] += w * u[i] * u[j];
    }
  }
  a[1][1] += ridge;
  a[2][2] += ridge;
  const auto determinant = [](const double m[3][3]) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  };
  const double below = determinant(a);
  for (int i = 0; i < 3; ++i)
    a[i][0] = b[i];
  return determinant(a) / below;
}

inline FittedFeatures feature_fit(const std::vector<Plane>& f, const std::vector<Plane>& v,
                                  const FeatureFitSettings& s) {
  FittedFeatures result{f, v};
  if (f.empty()) return result;
  const int width = f[0].width(), height = f[0].height();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::vector<std::vector<std::array<double, 4>>> points(f.size());
      std::vector<double> squares(f.size(), 0.0);
      double total = 0.0;
      for (int qy = std::max(y - s.radius, 0); qy <= std::min(y + s.radius, height - 1); ++qy) {
        for (int qx = std::max(x - s.radius, 0); qx <= std::min(x + s.radius, width - 1); ++qx) {
          const int dx = qx - x, dy = qy - y;
          const double z = feature_fit_distance(f, v, s, x, y, dx, dy) +
                           (dx * dx + dy * dy) / (2.0 * s.sigma * s.sigma);
          const double w = std::max(0.0, std::exp(-z) - std::exp(-8.0));
          total += w;
          for (std::size_t c = 0; c < f.size(); ++c) {
            points[c].push_back({w, static_cast<double>(dx) / s.radius,
                                 static_cast<double>(dy) / s.radius, f[c](qx, qy)});
            squares[c] += w * w * v[c](qx, qy);
          }
        }
      }
      for (std::size_t c = 0; c < f.size(); ++c) {
        result.mean[c](x, y) = constant_of_line(points[c], s.ridge);
        result.variance[c](x, y) = squares[c] / (total * total);
      }
    }
  }
  return result;
}

}  // namespace spool::reference
