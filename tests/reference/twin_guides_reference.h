// Slow twin of lib/filters/twin_guides: plain loops in double, every pair by itself.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "lib/core/extend.h"
#include "lib/filters/twin_guides/options.h"
#include "lib/statistics/feature_statistics.h"
#include "lib/statistics/piece_statistics.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool::reference {

using Planes = std::vector<Plane>;

// Gaussian of `sigma` pieces, cut at 4 sigma, mirrored at the border.
inline Plane blur(const Plane& image, double sigma) {
  const int reach = static_cast<int>(std::lround(4.0 * sigma));
  Plane out(image.width(), image.height());
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      double sum = 0.0, total = 0.0;
      for (int j = -reach; j <= reach; ++j) {
        for (int i = -reach; i <= reach; ++i) {
          const double w = std::exp(-(i * i + j * j) / (2.0 * sigma * sigma));
          sum += w *
                 image(extend_symmetric(x + i, out.width()), extend_symmetric(y + j, out.height()));
          total += w;
        }
      }
      out(x, y) = sum / total;
    }
  }
  return out;
}

// --- means under the features' weights -----------------------------------------------------------

struct BlendResult {
  Planes mean, variance;
};

inline BlendResult blend(const Planes& values, const Planes& variances, const Planes& f,
                         const Planes& fv, double tau, int patch, int radius, double sigma) {
  const int width = values[0].width(), height = values[0].height();
  const auto e = [&](int px, int py, int dx, int dy) {
    const int qx = std::clamp(px + dx, 0, width - 1), qy = std::clamp(py + dy, 0, height - 1);
    double largest = 0.0;
    for (std::size_t c = 0; c < f.size(); ++c) {
      const double d = f[c](px, py) - f[c](qx, qy), v = fv[c](px, py), u = fv[c](qx, qy);
      largest = std::max(largest, (d * d - (v + std::min(u, v))) / (v + u + tau));
    }
    return largest;
  };
  BlendResult out{values, variances};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double total = 0.0;
      std::vector<double> sum(values.size()), squares(variances.size());
      for (int dy = -radius; dy <= radius; ++dy) {
        for (int dx = -radius; dx <= radius; ++dx) {
          if (x + dx < 0 || x + dx >= width || y + dy < 0 || y + dy >= height) continue;
          double z = 0.0;
          int count = 0;
          for (int py = std::max(0, y - patch); py <= std::min(height - 1, y + patch); ++py) {
            for (int px = std::max(0, x - patch); px <= std::min(width - 1, x + patch); ++px) {
              z += e(px, py, dx, dy);
              ++count;
            }
          }
          z = z / count + (dx * dx + dy * dy) / (2.0 * sigma * sigma);
          const double w = std::max(0.0, std::exp(-z) - std::exp(-8.0));
          total += w;
          for (std::size_t i = 0; i < sum.size(); ++i)
            sum[i] += w * values[i](x + dx, y + dy);
          for (std::size_t i = 0; i < squares.size(); ++i)
            squares[i] += w * w * variances[i](x + dx, y + dy);
        }
      }
      for (std::size_t i = 0; i < sum.size(); ++i)
        out.mean[i](x, y) = sum[i] / total;
      for (std::size_t i = 0; i < squares.size(); ++i)
        out.variance[i](x, y) = squares[i] / (total * total);
    }
  }
  return out;
}

// --- moments -------------------------------------------------------------------------------------

struct Moments {
  Planes mean, variance, log_mean, log_variance;  // RGB
  Plane log_luminance;
};

// Mean and blurred variance of `value` over the samples taken of every piece.
template <class Value>
void mean_and_variance(const SamplePool& pool, const CountImage& n, double key, Value value,
                       Plane& mean, Plane& variance) {
  Plane m2(n.width(), n.height());
  mean = m2;
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x) {
      for (int i = 0; i < n(x, y); ++i)
        mean(x, y) += value(x, y, pool.sample(x, y, i)) / n(x, y);
      for (int i = 0; i < n(x, y); ++i)
        m2(x, y) += std::pow(value(x, y, pool.sample(x, y, i)) - mean(x, y), 2);
    }
  }
  GuardCounts guards;
  const int q = pool.pieces_per_side();
  variance = variance_of_mean(n, mean, m2, {VarianceMode::kAuto, key}, guards);
  variance = blur(fill_empty_pieces(variance, n, q, guards), 1.0);
  mean = fill_empty_pieces(mean, n, q, guards);
}

inline Moments moments(const SamplePool& pool, const CountImage& n, const Plane& limit,
                       const RadianceScale& scale) {
  const int q = pool.pieces_per_side();
  Moments out{Planes(3), Planes(3), Planes(3), Planes(3), {}};
  const auto log_of = [&](double v) {
    return std::log(std::max(v * scale.unit, 0.0) + 0.10 * scale.mean);
  };
  for (std::size_t c = 0; c < 3; ++c) {
    const auto clamped = [&](int x, int y, const Rgb& s) {
      const double l = luminance(s[0], s[1], s[2]), most = limit(x / q, y / q);
      return s[c] * scale.unit * (l > most ? most / l : 1.0);
    };
    mean_and_variance(pool, n, scale.mean, clamped, out.mean[c], out.variance[c]);
    mean_and_variance(
        pool, n, 1.0, [&](int, int, const Rgb& s) { return log_of(s[c]); }, out.log_mean[c],
        out.log_variance[c]);
  }
  Plane unused;
  mean_and_variance(
      pool, n, 1.0, [&](int, int, const Rgb& s) { return log_of(luminance(s[0], s[1], s[2])); },
      out.log_luminance, unused);
  return out;
}

// --- guides --------------------------------------------------------------------------------------

struct Guides {
  Planes value, variance;
};

inline Guides guides(const Moments& m, const Planes& clean, const Planes& clean_variance,
                     const RadianceScale& scale, const TwinGuidesOptions& options) {
  const BlendResult pilot = blend(m.mean, m.variance, clean, clean_variance, 1e-2, 0, 2, 0.7);
  Guides out;
  for (const double s : {options.guide_sigma, 2.0 * options.guide_sigma}) {
    const double k = std::max(1.0, 2.0 * std::numbers::pi * s * s);
    for (std::size_t c = 0; c < 3; ++c) {
      Plane p = blur(pilot.mean[c], s), pv = blur(pilot.variance[c], s);
      for (std::size_t i = 0; i < p.size(); ++i) {
        const double b = std::max(p[i], 0.0) + 0.05 * scale.mean;
        p[i] = std::log(b);
        pv[i] = options.slack * pv[i] / k / (b * b);
      }
      out.value.push_back(p);
      out.variance.push_back(pv);
      Plane t = blur(m.log_mean[c], s), tv = blur(m.log_variance[c], s);
      for (double& v : tv.pixels())
        v *= options.slack / k;
      out.value.push_back(t);
      out.variance.push_back(tv);
    }
  }
  return out;
}

// --- weights and fit -----------------------------------------------------------------------------

inline double window_weight(const Guides& g, const Planes& f, const Planes& fv,
                            const TwinGuidesOptions& options, int px, int py, int qx, int qy) {
  double feature = 0.0, guide = 0.0;
  for (std::size_t c = 0; c < f.size(); ++c) {
    const double d = f[c](px, py) - f[c](qx, qy), v = fv[c](px, py) + fv[c](qx, qy);
    feature = std::max(feature, (d * d - v) / (v + 1e-2));
  }
  for (std::size_t c = 0; c < g.value.size(); ++c) {
    const double d = g.value[c](px, py) - g.value[c](qx, qy);
    const double u = g.variance[c](px, py) + g.variance[c](qx, qy);
    guide += std::max(0.0, d * d - u) / (u + options.tau * options.tau);
  }
  const double distance = (px - qx) * (px - qx) + (py - qy) * (py - qy);
  const double z = distance / (2.0 * options.sigma * options.sigma) +
                   options.feature_gain * feature + guide / static_cast<double>(g.value.size());
  return std::max(0.0, std::exp(-z) - std::exp(-options.cut));
}

// Solves a x = b by elimination with row exchange; b is used up and holds x.
inline void solve(std::vector<std::vector<double>> a, std::vector<double>& b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t best = k;
    for (std::size_t i = k + 1; i < n; ++i) {
      if (std::abs(a[i][k]) > std::abs(a[best][k])) best = i;
    }
    std::swap(a[k], a[best]);
    std::swap(b[k], b[best]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = a[i][k] / a[k][k];
      for (std::size_t j = k; j < n; ++j)
        a[i][j] -= factor * a[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j)
      b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
  }
}

// weight(qx, qy) of the neighbours of (x, y); images in units.
template <class Weight>
std::array<double, 3> fit_at(int x, int y, const Moments& m, int n, const Planes& raw,
                             const Planes& clean, const TwinGuidesOptions& options, Weight weight) {
  const int width = m.log_luminance.width(), height = m.log_luminance.height();
  const std::size_t size = 3 + raw.size();
  struct Neighbour {
    double w, logarithm;
    std::array<double, 3> colour;
    std::vector<double> u;
  };
  std::vector<Neighbour> window;
  double total = 0.0, logarithms = 0.0;
  for (int qy = std::max(0, y - options.radius); qy <= std::min(height - 1, y + options.radius);
       ++qy) {
    for (int qx = std::max(0, x - options.radius); qx <= std::min(width - 1, x + options.radius);
         ++qx) {
      Neighbour q{
          weight(qx, qy), m.log_luminance(qx, qy), {}, {1.0, 0.1 * (qy - y), 0.1 * (qx - x)}};
      for (std::size_t c = 0; c < 3; ++c)
        q.colour[c] = m.mean[c](qx, qy);
      for (std::size_t c = 0; c < raw.size(); ++c)
        q.u.push_back(raw[c](qx, qy) - clean[c](x, y));
      total += q.w;
      logarithms += q.w * q.logarithm;
      window.push_back(q);
    }
  }
  const double top = std::max(options.limit, 1.25 * n) * std::exp(logarithms / total);
  std::array<double, 3> out{};
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<std::vector<double>> a(size, std::vector<double>(size));
    std::vector<double> b(size);
    double least = 0.0;
    for (const Neighbour& q : window) {
      const double l = luminance(q.colour[0], q.colour[1], q.colour[2]);
      const double value = q.colour[c] * (l > top ? top / l : 1.0);
      if (q.w > 0.0) least = std::min(least, value);
      for (std::size_t i = 0; i < size; ++i) {
        for (std::size_t j = 0; j < size; ++j)
          a[i][j] += q.w * q.u[i] * q.u[j];
        b[i] += q.w * q.u[i] * value;
      }
    }
    for (std::size_t i = 1; i < size; ++i)
      a[i][i] += options.ridge;
    solve(a, b);
    out[c] = std::max(b[0], least);
  }
  return out;
}

// --- the whole -----------------------------------------------------------------------------------

// The image of pieces. `limit`: of the samples' luminance (sample_clamp_reference.h); `scale` says
// the units, which divide out.
inline RgbImage twin_guides(const SamplePool& pool, const CountImage& n, const Plane& limit,
                            const RadianceScale& scale, const TwinGuidesOptions& options) {
  const int width = n.width(), height = n.height();
  const Moments m = moments(pool, n, limit, scale);
  Planes raw, raw_variance;
  for (const FeatureLayer& layer : pool.recording().features()) {
    GuardCounts guards;
    const auto feature =
        feature_statistics(pool, n, layer, guards, layer.name == "depth" ? 1e15 : 4.0);
    for (std::size_t c = 0; c < feature->mean.size(); ++c) {
      raw.push_back(feature->mean[c]);
      raw_variance.push_back(blur(feature->variance[c], 1.0));
    }
  }
  Planes clean, clean_variance;
  if (!raw.empty()) {
    BlendResult cleaned = blend(raw, raw_variance, raw, raw_variance, 1e-3, 1, 5, 4.0);
    clean = cleaned.mean;
    clean_variance = cleaned.variance;
  }
  const Guides g = guides(m, clean, clean_variance, scale, options);
  RgbImage out = make_rgb(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto value = fit_at(x, y, m, n(x, y), raw, clean, options, [&](int qx, int qy) {
        return window_weight(g, clean, clean_variance, options, x, y, qx, qy);
      });
      for (std::size_t c = 0; c < 3; ++c)
        out[c](x, y) = value[c] / scale.unit;
    }
  }
  return out;
}

}  // namespace spool::reference
