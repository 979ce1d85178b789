// Slow twin of lib/filters/twin_guides: plain loops in double, every pair by itself.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "lib/core/extend.h"
#include "lib/filters/twin_guides/options.h"
#include "lib/filters/twin_guides/sample_moments.h"
#include "lib/statistics/feature_statistics.h"
#include "lib/statistics/piece_statistics.h"
#include "lib/statistics/variance_of_mean.h"
#include "tests/reference/blur_reference.h"
#include "tests/reference/event_places_reference.h"
#include "tests/reference/feature_fit_reference.h"
#include "tests/reference/grown_variance_reference.h"

namespace spool::reference {

using Planes = std::vector<Plane>;

// --- means under the features' weights -----------------------------------------------------------

struct BlendResult {
  Planes mean, variance;
};

inline BlendResult blend(const Planes& values, const Planes& variances, const Planes& f,
                         const Planes& fv, double tau, int radius, double sigma) {
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
          const double z = e(x, y, dx, dy) + (dx * dx + dy * dy) / (2.0 * sigma * sigma);
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
  Planes mean, variance, difference, log_mean, log_variance;  // RGB
  Plane log_luminance;
  Planes clamped_light;  // by group
};

// Mean and blurred variance of `value` over the samples taken of every piece.
template <class Value>
void mean_and_variance(const SamplePool& pool, const CountImage& n, double key,
                       const NoisePool& noise_pool, Value value, Plane& mean, Plane& variance) {
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
  variance = fill_empty_pieces(variance, n, q, guards);
  const Plane whole = variance;
  variance = blur(variance, 1.0);
  if (!noise_pool.unused()) {
    const Plane grown = grown_variance(whole, noise_pool.radius);
    for (std::size_t i = 0; i < variance.size(); ++i)
      variance[i] = (1.0 + noise_pool.share[i] * std::min(1.0, 8.0 / std::max(n[i], 1))) *
                    (variance[i] + noise_pool.share[i] * std::max(0.0, grown[i] - variance[i]));
  }
  mean = fill_empty_pieces(mean, n, q, guards);
}

// (mean of even - mean of odd) sqrt(n_even n_odd) / n.
template <class Value>
Plane difference_of_halves(const SamplePool& pool, const CountImage& n, Value value) {
  Plane difference(n.width(), n.height());
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x) {
      std::array<double, 2> sum{}, count{};
      for (int i = 0; i < n(x, y); ++i) {
        sum[static_cast<std::size_t>(i % 2)] += value(x, y, pool.sample(x, y, i));
        count[static_cast<std::size_t>(i % 2)] += 1.0;
      }
      if (n(x, y) < 2) continue;
      difference(x, y) = (sum[0] / count[0] - sum[1] / count[1]) * std::sqrt(count[0] * count[1]) /
                         (count[0] + count[1]);
    }
  }
  GuardCounts guards;
  return fill_empty_pieces(difference, n, pool.pieces_per_side(), guards);
}

// Mean luminance above the limit of samples k, k + m, ..., in units.
inline Planes clamped_light(const SamplePool& pool, const CountImage& n, const Plane& limit,
                            double unit) {
  int m = 4;
  for (const std::int32_t count : n.pixels())
    m = count > 0 ? std::min(m, count) : m;
  const int q = pool.pieces_per_side();
  Planes light(static_cast<std::size_t>(m), Plane(n.width(), n.height()));
  for (int k = 0; k < m; ++k) {
    for (int y = 0; y < n.height(); ++y) {
      for (int x = 0; x < n.width(); ++x) {
        double sum = 0.0, count = 0.0;
        for (int i = k; i < n(x, y); i += m) {
          const Rgb s = pool.sample(x, y, i);
          sum += std::max(0.0, luminance(s[0], s[1], s[2]) - limit(x / q, y / q)) * unit;
          count += 1.0;
        }
        if (count > 0.0) light[static_cast<std::size_t>(k)](x, y) = sum / count;
      }
    }
  }
  return light;
}

inline Moments moments(const SamplePool& pool, const CountImage& n, const Plane& limit,
                       const NoisePool& noise_pool, const RadianceScale& scale) {
  const int q = pool.pieces_per_side();
  Moments out{Planes(3), Planes(3), Planes(3), Planes(3), Planes(3), {}, {}};
  const auto log_of = [&](double v) {
    return std::log(std::max(v * scale.unit, 0.0) + 0.10 * scale.mean);
  };
  for (std::size_t c = 0; c < 3; ++c) {
    const auto clamped = [&](int x, int y, const Rgb& s) {
      const double l = luminance(s[0], s[1], s[2]), most = limit(x / q, y / q);
      return s[c] * scale.unit * (l > most ? most / l : 1.0);
    };
    mean_and_variance(pool, n, scale.mean, noise_pool, clamped, out.mean[c], out.variance[c]);
    out.difference[c] = difference_of_halves(pool, n, clamped);
    mean_and_variance(
        pool, n, 1.0, noise_pool, [&](int, int, const Rgb& s) { return log_of(s[c]); },
        out.log_mean[c], out.log_variance[c]);
  }
  Plane unused;
  const Plane nowhere;
  mean_and_variance(
      pool, n, 1.0, {0, nowhere},
      [&](int, int, const Rgb& s) { return log_of(luminance(s[0], s[1], s[2])); },
      out.log_luminance, unused);
  out.clamped_light = clamped_light(pool, n, limit, scale.unit);
  return out;
}

// T (1 + opening h agreed / kept), of what the clamp at T takes and keeps around each pixel; the
// share of pooled noise of pixels of one piece, or nothing where it is 0 everywhere.
inline Plane open_limits(const SamplePool& pool, const CountImage& n, double unit,
                         const TwinGuidesOptions& options, Plane& limit) {
  if (options.opening == 0.0) return {};
  const Planes taken = clamped_light(pool, n, limit, unit);
  if (taken.size() < 2) return {};
  Plane kept(n.width(), n.height()), agreed(n.width(), n.height(), INFINITY);
  Planes above(taken.size(), Plane(n.width(), n.height()));
  double samples = 0.0, pixels = 0.0;
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x) {
      const auto at = [&](int i) {
        const Rgb s = pool.sample(x, y, i);
        return luminance(s[0], s[1], s[2]);
      };
      for (int i = 0; i < n(x, y); ++i)
        kept(x, y) += unit * std::min(at(i), limit(x, y)) / n(x, y);
      for (std::size_t k = 0; k < above.size(); ++k) {
        double count = 0.0, all = 0.0;
        for (int i = static_cast<int>(k); i < n(x, y); i += static_cast<int>(above.size()))
          count += at(i) > limit(x, y) ? 1.0 : 0.0, all += 1.0;
        if (all > 0.0) above[k](x, y) = count / all;
      }
      samples += n(x, y);
      pixels += n(x, y) > 0 ? 1.0 : 0.0;
    }
  }
  const EventPlaces places =
      event_places(above, 1.5, options.clamp_sigma,
                   samples / std::max(pixels, 1.0) / static_cast<double>(above.size()));
  kept = blur(kept, options.clamp_sigma);
  for (const Plane& group : taken) {
    const Plane around = blur(group, options.clamp_sigma);
    for (std::size_t i = 0; i < agreed.size(); ++i)
      agreed[i] = std::min(agreed[i], around[i]);
  }
  Plane heavy(n.width(), n.height());
  double most = 0.0;
  for (std::size_t i = 0; i < limit.size(); ++i) {
    const double ratio = kept[i] > 0.0 ? agreed[i] / kept[i] : 0.0;
    const auto ramp = [](double v, double from, double to) {
      return std::min(1.0, std::max(0.0, (v - from) / (to - from)));
    };
    const double h = options.heavy;
    const auto heaviness = [&](double v) { return h > 0.0 ? ramp(v / h, 0.25, 1.0) : v > 0.0; };
    limit[i] *= 1.0 + options.opening * heaviness(ratio) * ratio;
    heavy[i] = heaviness(0.5 * ratio) *
               std::max(ramp(places.correlation[i], 1.7, 1.2), ramp(places.density[i], 1.0, 2.0));
    most = std::max(most, heavy[i]);
  }
  return most > 0.0 ? heavy : Plane();
}

// --- guides --------------------------------------------------------------------------------------

struct Guides {
  Planes value, variance;
};

// Means and variances of the pilot, channels 0-2, and of the logarithms, 3-5.
struct GuideLevel {
  double sigma;
  Planes mean, variance;
};

inline GuideLevel guide_sources(const Moments& m, const Planes& clean,
                                const Planes& clean_variance) {
  const BlendResult pilot = blend(m.mean, m.variance, clean, clean_variance, 1e-2, 2, 0.7);
  GuideLevel level{0.0, pilot.mean, pilot.variance};
  level.mean.insert(level.mean.end(), m.log_mean.begin(), m.log_mean.end());
  level.variance.insert(level.variance.end(), m.log_variance.begin(), m.log_variance.end());
  return level;
}

inline GuideLevel blurred(GuideLevel level, double sigma, double taps_sigma, int dilation = 1) {
  level.sigma = sigma;
  for (Planes* planes : {&level.mean, &level.variance}) {
    for (Plane& plane : *planes)
      plane = blur(plane, taps_sigma, dilation);
  }
  return level;
}

// Long along the structure of the pilot, short across it: an angle, and a sum over the window.
inline GuideLevel blurred_along(const GuideLevel& from, double sigma, double stretch,
                                double scene_luminance) {
  const int width = from.mean[0].width(), height = from.mean[0].height();
  Plane l(width, height), xx = l, xy = l, yy = l;
  for (std::size_t i = 0; i < l.size(); ++i) {
    const double mean = (from.mean[0][i] + from.mean[1][i] + from.mean[2][i]) / 3.0;
    l[i] = std::log(std::max(mean, 0.0) + 0.10 * scene_luminance);
  }
  l = blur(l, 1.0);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double gx = l(std::min(x + 1, width - 1), y) - l(std::max(x - 1, 0), y);
      const double gy = l(x, std::min(y + 1, height - 1)) - l(x, std::max(y - 1, 0));
      xx(x, y) = gx * gx, xy(x, y) = gx * gy, yy(x, y) = gy * gy;
    }
  }
  xx = blur(xx, 2.0), xy = blur(xy, 2.0), yy = blur(yy, 2.0);
  int reach = 5;
  while (reach < std::sqrt(14.0) * sigma || reach < 5.0 * sigma * (1.0 + stretch) / 3.0)
    ++reach;
  GuideLevel to = from;
  to.sigma = sigma;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double a = xx(x, y), b = xy(x, y), c = yy(x, y);
      const double angle = 0.5 * std::atan2(2.0 * b, a - c);  // of the gradient
      const double coherence = std::hypot(a - c, 2.0 * b) / (a + c + 1e-4);
      const double f = 1.0 + stretch * coherence * coherence;
      double total = 0.0;
      std::array<double, 12> sum{};
      for (int j = -reach; j <= reach; ++j) {
        for (int i = -reach; i <= reach; ++i) {
          const double across = i * std::cos(angle) + j * std::sin(angle);
          const double along = j * std::cos(angle) - i * std::sin(angle);
          const double z = std::pow(across * f / sigma, 2) + std::pow(along / f / sigma, 2);
          const double w = std::max(0.0, std::exp(-z / 2.0) - std::exp(-7.0));
          const int qx = extend_symmetric(x + i, width), qy = extend_symmetric(y + j, height);
          total += w;
          for (std::size_t k = 0; k < 6; ++k) {
            sum[k] += w * from.mean[k](qx, qy);
            sum[k + 6] += w * from.variance[k](qx, qy);
          }
        }
      }
      for (std::size_t k = 0; k < 6; ++k) {
        to.mean[k](x, y) = sum[k] / total;
        to.variance[k](x, y) = sum[k + 6] / total;
      }
    }
  }
  return to;
}

// Levels guide_sigma, 2 guide_sigma, ... as many as asked for.
inline std::vector<GuideLevel> guide_levels(const GuideLevel& sources, int count,
                                            const RadianceScale& scale,
                                            const TwinGuidesOptions& options) {
  const double s = options.guide_sigma;
  std::vector<GuideLevel> levels = {
      blurred(sources, s, s), options.stretch > 0.0
                                  ? blurred_along(sources, 2.0 * s, options.stretch, scale.mean)
                                  : blurred(sources, 2.0 * s, 2.0 * s)};
  for (int step = 1; static_cast<int>(levels.size()) < count; step *= 2)
    levels.push_back(
        blurred(levels.back(), 2.0 * levels.back().sigma, std::sqrt(3.0) * 2.0 * s, step));
  return levels;
}

// With small_noise of a mean in place of a sample.
inline TwinGuidesOptions noise_of_means(TwinGuidesOptions options, const CountImage& n) {
  double samples = 0.0;
  for (const int count : n.pixels())
    samples += count;
  options.small_noise /= std::sqrt(samples / static_cast<double>(n.size()));
  return options;
}

// Of the scale whose levels are k and k + 1; options: noise_of_means.
inline Guides guides(const std::vector<GuideLevel>& levels, std::size_t k,
                     const RadianceScale& scale, const TwinGuidesOptions& options) {
  Guides out;
  for (const GuideLevel& level : {levels[k], levels[k + 1]}) {
    const double left = 1.0 / std::max(1.0, 2.0 * std::numbers::pi * level.sigma * level.sigma);
    const auto with_slack = [&](double v) {
      const double small = options.small_noise * options.small_noise;
      return v < small ? options.small_slack * v
                       : options.small_slack * small + options.slack * (v - small);
    };
    for (std::size_t c = 0; c < 3; ++c) {
      Plane p = level.mean[c], pv = level.variance[c], tv = level.variance[c + 3];
      for (std::size_t i = 0; i < p.size(); ++i) {
        const double b = std::max(p[i], 0.0) + 0.05 * scale.mean;
        p[i] = std::log(b);
        pv[i] = with_slack(pv[i] * left / (b * b));
        tv[i] = with_slack(tv[i] * left);
      }
      out.value.insert(out.value.end(), {p, level.mean[c + 3]});
      out.variance.insert(out.variance.end(), {pv, tv});
    }
  }
  return out;
}

// --- weights and fit -----------------------------------------------------------------------------

// sigma in pieces of the image.
inline double window_weight(const Guides& g, const Planes& f, const Planes& fv, double sigma,
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
  const double z = distance / (2.0 * sigma * sigma) + options.feature_gain * feature +
                   guide / static_cast<double>(g.value.size());
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

// What the fits of one scale see.
struct Inputs {
  Planes colour, difference, features;
  Plane logarithm, x, y;  // x, y: where the mean of colours lies, pieces
};

inline Inputs finest_inputs(const Moments& m, const Planes& raw) {
  Inputs in{m.mean, m.difference, raw, m.log_luminance, m.log_luminance, m.log_luminance};
  for (int y = 0; y < in.x.height(); ++y) {
    for (int x = 0; x < in.x.width(); ++x)
      in.x(x, y) = x, in.y(x, y) = y;
  }
  return in;
}

// visit(qx, qy, dx, dy) of the taps of a window inside the image, `step` apart.
template <class Visit>
void visit_window(const Plane& image, int x, int y, int radius, int step, Visit visit) {
  for (int dy = -radius; dy <= radius; ++dy) {
    for (int dx = -radius; dx <= radius; ++dx) {
      const int qx = x + dx * step, qy = y + dy * step;
      if (qx >= 0 && qx < image.width() && qy >= 0 && qy < image.height()) visit(qx, qy, dx, dy);
    }
  }
}

// weight(px, py, qx, qy) of the window.
template <class Weight>
Inputs coarser_inputs(const Inputs& in, int step, const TwinGuidesOptions& options, Weight weight) {
  Inputs out = in;
  const auto mean = [&](const Plane& from, Plane& to) {
    for (int y = 0; y < from.height(); ++y) {
      for (int x = 0; x < from.width(); ++x) {
        double sum = 0.0, total = 0.0;
        visit_window(from, x, y, std::min(2, options.radius), step,
                     [&](int qx, int qy, int dx, int dy) {
                       const double d2 = dx * dx + dy * dy;
                       const double w =
                           weight(x, y, qx, qy) *
                           std::exp(d2 / (2.0 * options.sigma * options.sigma) - d2 / (2.0 * 1.44));
                       sum += w * from(qx, qy);
                       total += w;
                     });
        to(x, y) = sum / total;
      }
    }
  };
  for (std::size_t c = 0; c < 3; ++c) {
    mean(in.colour[c], out.colour[c]);
    mean(in.difference[c], out.difference[c]);
  }
  for (std::size_t c = 0; c < in.features.size(); ++c)
    mean(in.features[c], out.features[c]);
  mean(in.logarithm, out.logarithm);
  mean(in.x, out.x);
  mean(in.y, out.y);
  return out;
}

// Three colours, then their differences; weight(qx, qy) of the neighbours of (x, y); images in
// units.
template <class Weight>
std::array<double, 6> fit_at(int x, int y, int step, double ridge, const Inputs& in, int n,
                             double heavy, const Planes& clean, const TwinGuidesOptions& options,
                             Weight weight) {
  const std::size_t size = 3 + in.features.size();
  struct Neighbour {
    double w, logarithm;
    std::array<double, 6> colour;
    std::vector<double> u;
  };
  std::vector<Neighbour> window;
  double total = 0.0, logarithms = 0.0;
  visit_window(in.logarithm, x, y, options.radius, step, [&](int qx, int qy, int, int) {
    Neighbour q{weight(qx, qy),
                in.logarithm(qx, qy),
                {},
                {1.0, 0.1 * (in.y(qx, qy) - y) / step, 0.1 * (in.x(qx, qy) - x) / step}};
    for (std::size_t c = 0; c < 3; ++c) {
      q.colour[c] = in.colour[c](qx, qy);
      q.colour[c + 3] = in.difference[c](qx, qy);
    }
    for (std::size_t c = 0; c < in.features.size(); ++c)
      q.u.push_back(in.features[c](qx, qy) - clean[c](x, y));
    total += q.w;
    logarithms += q.w * q.logarithm;
    window.push_back(q);
  });
  const auto luminance_of = [](const Neighbour& q) {
    return luminance(q.colour[0], q.colour[1], q.colour[2]);
  };
  double mean = 0.0, deviations = 0.0;
  for (const Neighbour& q : window)
    mean += q.w * luminance_of(q) / total;
  for (const Neighbour& q : window)
    deviations += std::pow(q.w * (luminance_of(q) - mean), 2);
  const double bound = mean - (2.0 - 1.5 * heavy) * std::sqrt(deviations) / total;
  const double top =
      std::max(options.limit, 1.25 * n) * std::max(std::exp(logarithms / total), 3.0 * bound);
  std::array<double, 6> out{};
  for (std::size_t c = 0; c < 6; ++c) {
    std::vector<std::vector<double>> a(size, std::vector<double>(size));
    std::vector<double> b(size);
    double least = 0.0;
    for (const Neighbour& q : window) {
      const double l = luminance_of(q);
      const double value = q.colour[c] * (l > top ? top / l : 1.0);
      if (q.w > 0.0) least = std::min(least, value);
      for (std::size_t i = 0; i < size; ++i) {
        for (std::size_t j = 0; j < size; ++j)
          a[i][j] += q.w * q.u[i] * q.u[j];
        b[i] += q.w * q.u[i] * value;
      }
    }
    for (std::size_t i = 1; i < size; ++i)
      a[i][i] += ridge;
    solve(a, b);
    out[c] = c < 3 ? std::max(b[0], least) : b[0];
  }
  return out;
}

// --- scales --------------------------------------------------------------------------------------

struct ScaleResult {
  Planes image, noise;
};

inline ScaleResult fit_scale(const Inputs& in, int step, double ridge, const CountImage& n,
                             const Plane& heavy, const Guides& g, const Planes& clean,
                             const Planes& clean_variance, const TwinGuidesOptions& options) {
  const int width = n.width(), height = n.height();
  ScaleResult out{Planes(3, Plane(width, height)), Planes(3, Plane(width, height))};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto value =
          fit_at(x, y, step, ridge, in, n(x, y), heavy.size() > 0 ? heavy(x, y) : 0.0, clean,
                 options, [&](int qx, int qy) {
                   return window_weight(g, clean, clean_variance, options.sigma * step, options, x,
                                        y, qx, qy);
                 });
      for (std::size_t c = 0; c < 3; ++c) {
        out.image[c](x, y) = value[c];
        out.noise[c](x, y) = value[c + 3];
      }
    }
  }
  return out;
}

// Means under the weights of windows of radius 2, sigma 1.5, with taps 2, 4 and 8 apart.
inline Plane guided_mean(Plane image, const std::vector<GuideLevel>& levels, const Planes& clean,
                         const Planes& clean_variance, const RadianceScale& scale,
                         const TwinGuidesOptions& options) {
  for (std::size_t k = 1; k <= 3; ++k) {
    const Guides g = guides(levels, k, scale, options);
    const int step = 1 << k;
    const Plane from = image;
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        double sum = 0.0, total = 0.0;
        visit_window(image, x, y, 2, step, [&](int qx, int qy, int, int) {
          const double w =
              window_weight(g, clean, clean_variance, 1.5 * step, options, x, y, qx, qy);
          sum += w * from(qx, qy);
          total += w;
        });
        image(x, y) = sum / total;
      }
    }
  }
  return image;
}

// mean(plane): the guided mean.
template <class Mean>
Planes blend_scales(const std::vector<ScaleResult>& scales, double scene_luminance, double slack,
                    const NoisePool& noise_pool, Mean mean) {
  Planes out = scales.back().image;
  const Planes& picture = scales[std::min<std::size_t>(2, scales.size() - 1)].image;
  for (std::size_t k = scales.size() - 1; k-- > 0;) {
    const Plane empty(out[0].width(), out[0].height());
    Plane d = empty, n = empty, v = empty;
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < empty.size(); ++i) {
        const double floor = 0.1 * scene_luminance;
        const double level = std::pow(std::max(picture[c][i], 0.0), 2) + floor * floor;
        const double coarse = scales[k + 1].noise[c][i], e = scales[k].noise[c][i] - coarse;
        d[i] += std::pow(scales[k].image[c][i] - scales[k + 1].image[c][i], 2) / (3.0 * level);
        n[i] += e * e / (3.0 * level);
        v[i] += e * coarse / (3.0 * level);
      }
    }
    if (!noise_pool.unused()) {
      const Plane grown = grown_variance(n, noise_pool.radius);
      for (std::size_t i = 0; i < n.size(); ++i)
        n[i] += noise_pool.share[i] * (grown[i] - n[i]);
    }
    d = mean(d), n = mean(n), v = mean(v);
    for (std::size_t i = 0; i < empty.size(); ++i) {
      const double signal = d[i] - slack * (n[i] + v[i]);
      const double a = signal > 0.0 ? std::min(1.0, signal / d[i]) : 0.0;
      for (std::size_t c = 0; c < 3; ++c)
        out[c][i] += a * (scales[k].image[c][i] - out[c][i]);
    }
  }
  return out;
}

// The mean under the weights of the finest guides, features ten times as strong, as far as `share`.
inline void join_lattices(Planes& out, const Plane& share, const Guides& g, const Planes& clean,
                          const Planes& clean_variance, TwinGuidesOptions options) {
  options.feature_gain *= 10.0;
  const Planes from = out;
  for (std::size_t c = 0; c < out.size(); ++c) {
    for (int y = 0; y < share.height(); ++y) {
      for (int x = 0; x < share.width(); ++x) {
        double sum = 0.0, total = 0.0;
        visit_window(share, x, y, 3, 1, [&](int qx, int qy, int, int) {
          const double w = window_weight(g, clean, clean_variance, 2.0, options, x, y, qx, qy);
          sum += w * from[c](qx, qy);
          total += w;
        });
        out[c](x, y) += share(x, y) * (sum / total - out[c](x, y));
      }
    }
  }
}

inline Planes return_agreed_light(Planes out, Planes taken, double sigma, double scene_luminance) {
  if (sigma == 0.0 || taken.size() < 2) return out;
  Plane shape(out[0].width(), out[0].height());
  for (std::size_t i = 0; i < shape.size(); ++i)
    shape[i] = std::max(0.0, luminance(out[0][i], out[1][i], out[2][i])) + 0.1 * scene_luminance;
  Plane factor(shape.width(), shape.height(), 1.0);
  for (const double reach : {0.25 * sigma, sigma}) {
    const Plane around_shape = blur(shape, reach);
    Planes around;
    for (const Plane& group : taken)
      around.push_back(blur(group, reach));
    for (std::size_t i = 0; i < shape.size(); ++i) {
      std::vector<double> groups;
      for (const Plane& group : around)
        groups.push_back(group[i]);
      std::sort(groups.begin(), groups.end());
      double light = groups[0];
      if (reach == sigma)
        light = std::accumulate(groups.begin(), groups.end() - 1, 0.0) /
                static_cast<double>(groups.size() - 1);
      if (light <= 0.0) continue;
      factor[i] += light / around_shape[i];
      if (reach == sigma) continue;
      for (std::size_t k = 0; k < taken.size(); ++k)
        taken[k][i] *= 1.0 - light / around[k][i];
    }
  }
  for (Plane& channel : out) {
    for (std::size_t i = 0; i < channel.size(); ++i)
      channel[i] *= factor[i];
  }
  return out;
}

// --- the whole -----------------------------------------------------------------------------------

// The image of pieces. `limit`: of the samples' luminance (sample_clamp_reference.h); `scale` says
// the units, which divide out.
inline RgbImage twin_guides(const SamplePool& pool, const CountImage& n, Plane limit,
                            const RadianceScale& scale, const TwinGuidesOptions& chosen) {
  const TwinGuidesOptions options = noise_of_means(chosen, n);
  const Plane heavy = open_limits(pool, n, scale.unit, options, limit);
  const NoisePool noise_pool{options.noise_pool, heavy};
  Moments m = moments(pool, n, limit, noise_pool, scale);
  Planes raw, raw_variance;
  for (const FeatureLayer& layer : pool.recording().features()) {
    GuardCounts guards;
    const auto feature =
        feature_statistics(pool, n, layer, guards, layer.name == "depth" ? 1e15 : 4.0);
    double first = 0.0, second = 0.0;
    for (const Plane& mean : feature->mean) {
      for (const double v : mean.pixels()) {
        first += std::abs(v);
        second += v * v;
      }
    }
    const bool dark = layer.name == "albedo" && second > 0.0 && second < 0.3 * first;
    const double factor = dark ? 0.3 * first / second : 1.0;
    for (std::size_t c = 0; c < feature->mean.size(); ++c) {
      Plane mean = feature->mean[c], variance = blur(feature->variance[c], 1.0);
      for (double& v : mean.pixels())
        v *= factor;
      for (double& v : variance.pixels())
        v *= factor * factor;
      raw.push_back(mean);
      raw_variance.push_back(variance);
    }
  }
  Planes clean, clean_variance;
  if (!raw.empty()) {
    FittedFeatures cleaned = feature_fit(raw, raw_variance, {1e-3, 1.5, 3.0, 1, 5, 4.0, 0.01});
    clean = cleaned.mean;
    clean_variance = cleaned.variance;
  }
  // A window of four scales reaches 48 pieces, a tenth of 512: nearer to 512 than to 256.
  const double octaves = std::log2(std::min(n.width(), n.height()) / 256.0);
  const int count = options.scales.value_or(octaves > 0.5 ? 4 : 3);
  const std::vector<GuideLevel> levels =
      guide_levels(guide_sources(m, clean, clean_variance), std::max(5, count + 1), scale, options);
  std::vector<ScaleResult> scales;
  Inputs in = finest_inputs(m, raw);
  for (int k = 0, step = 1; k < count; ++k, step *= 2) {
    const Guides g = guides(levels, static_cast<std::size_t>(k), scale, options);
    scales.push_back(fit_scale(in, step, options.ridge * std::pow(0.25, k), n, heavy, g, clean,
                               clean_variance, options));
    in = coarser_inputs(in, step, options, [&](int px, int py, int qx, int qy) {
      return window_weight(g, clean, clean_variance, options.sigma * step, options, px, py, qx, qy);
    });
  }
  const double slack = options.detail_slack * (raw.empty() ? 0.5 : 1.0);
  Planes blended = blend_scales(scales, scale.mean, slack, noise_pool, [&](const Plane& plane) {
    return guided_mean(plane, levels, clean, clean_variance, scale, options);
  });
  if (!noise_pool.unused() && count > 1)
    join_lattices(blended, heavy, guides(levels, 0, scale, options), clean, clean_variance,
                  options);
  blended = return_agreed_light(blended, m.clamped_light, options.agreement, scale.mean);
  RgbImage out = make_rgb(n.width(), n.height());
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < out[c].size(); ++i)
      out[c][i] = blended[c][i] / scale.unit;
  }
  return out;
}

}  // namespace spool::reference
