// Slow twin of lib/filters/directional/filter_size.h: every region summed by itself.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/core/extend.h"
#include "lib/filters/directional/filter_size.h"

namespace spool::reference {

struct FilterSizes {
  CountImage level;
  std::vector<Plane> t;       // T_k
  std::vector<Plane> vote;    // blurred votes, own one out where the rule says so
  std::vector<Plane> beyond;  // how far the difference is beyond its noise, squared
};

// Blurred votes of step k; the piece's own one out where the rule says so.
inline Plane votes(const Plane& stop, int k, SizeSmooth smooth) {
  const int width = stop.width(), height = stop.height();
  Plane vote(width, height);
  const double sigma = std::fmax(0.8, 0.7 * std::pow(2.0, k));
  const int radius = static_cast<int>(std::ceil(3.0 * sigma));
  double total = 0.0;
  for (int i = -radius; i <= radius; ++i)
    total += std::exp(-0.5 * i * i / (sigma * sigma));
  const double own = std::fmax(0.0, 1.0 / (total * total) - 0.01);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0.0;
      for (int dy = -radius; dy <= radius; ++dy) {
        for (int dx = -radius; dx <= radius; ++dx) {
          sum += std::exp(-0.5 * (dx * dx + dy * dy) / (sigma * sigma)) *
                 stop(extend_symmetric(x + dx, width), extend_symmetric(y + dy, height));
        }
      }
      vote(x, y) = sum / (total * total);
      if (smooth == SizeSmooth::kOpensOnly)
        vote(x, y) = (vote(x, y) - own * stop(x, y)) / (1.0 - own);
    }
  }
  return vote;
}

inline bool stops(double stop, double vote, double beyond, const FilterSizeOptions& options) {
  if (options.evidence > 0.0 && beyond > 0.0) return true;
  const bool asked = vote >= 0.5 - 1e-9;
  if (options.smooth == SizeSmooth::kOn) return asked;
  if (options.smooth == SizeSmooth::kOpensOnly) return stop > 0.0 && asked;
  return stop > 0.0;
}

// Each variance, but at least the fifth of the nine around it.
inline Plane cautious_variance(const Plane& variance) {
  const int width = variance.width(), height = variance.height();
  Plane result(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::vector<double> nine;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx)
          nine.push_back(
              variance(extend_symmetric(x + dx, width), extend_symmetric(y + dy, height)));
      }
      std::sort(nine.begin(), nine.end());
      result(x, y) = std::fmax(variance(x, y), nine[4]);
    }
  }
  return result;
}

// The step to the base image of one signal, whose taps are 1-D, odd and sum to 1: 1 where refused.
inline Plane refused_base(const Plane& mean, const Plane& variance, const std::vector<double>& taps,
                          const FilterSizeOptions& options, Plane* t) {
  const int width = mean.width(), height = mean.height(), r = static_cast<int>(taps.size()) / 2;
  Plane stop(width, height), beyond(width, height), refused(width, height);
  const Plane cautious = reference::cautious_variance(variance);
  *t = Plane(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double base = 0.0, base_variance = 0.0, noise = 0.0;
      for (int j = -r; j <= r; ++j) {
        for (int i = -r; i <= r; ++i) {
          const double w =
              taps[static_cast<std::size_t>(i + r)] * taps[static_cast<std::size_t>(j + r)];
          const int px = extend_symmetric(x + i, width), py = extend_symmetric(y + j, height);
          base += w * mean(px, py);
          base_variance += w * w * variance(px, py);
          const double moved = i == 0 && j == 0 ? 1.0 - w : w;
          noise += moved * moved * cautious(px, py);
        }
      }
      const double dq = base - mean(x, y), v = variance(x, y);
      (*t)(x, y) = base_variance - v + options.factor.constant * dq * dq;
      stop(x, y) = (*t)(x, y) > 0.0 ? 1.0 : 0.0;
      const double z2 = options.evidence * options.evidence;
      beyond(x, y) = dq * dq - z2 * noise;
      // Regions of 4 x 4 pieces around the piece and its right, lower and lower-right neighbours.
      for (int dy = 0; dy < 2 && y + dy < height; ++dy) {
        for (int dx = 0; dx < 2 && x + dx < width; ++dx) {
          double sum = 0.0, noises = 0.0, count = 0.0;
          for (int py = std::max(0, y + dy - 2); py < std::min(height, y + dy + 2); ++py) {
            for (int px = std::max(0, x + dx - 2); px < std::min(width, x + dx + 2); ++px) {
              sum += mean(px, py), noises += cautious(px, py), count += 1.0;
            }
          }
          const double far = sum / count - mean(x, y);
          const double var = noises / (count * count) + (1.0 - 2.0 / 16.0) * cautious(x, y);
          beyond(x, y) = std::fmax(beyond(x, y), far * far - 25.0 / 9.0 * z2 * var);
        }
      }
    }
  }
  const Plane vote = votes(stop, -1, options.smooth);
  for (std::size_t i = 0; i < stop.size(); ++i)
    refused[i] = stops(stop[i], vote[i], beyond[i], options) ? 1.0 : 0.0;
  return refused;
}

inline FilterSizes filter_size(const FilterSizeInput& input, const FilterSizeOptions& options) {
  const int width = input.mean.width(), height = input.mean.height();
  const auto contrast = [&](double low, double high, long long samples) {
    if (samples < 2) return 0.0;
    const bool guarded = options.contrast == ContrastForm::kGuarded;
    if (!guarded && std::abs(high + low) < 1e-30) return 0.0;
    const double c = guarded ? (high - low) / (std::abs(high) + std::abs(low) + 1e-4)
                             : (high - low) / (high + low);
    return c * c;
  };
  const Plane cautious = reference::cautious_variance(input.variance);
  struct Region {
    double s = 0.0, q = 0.0, samples = 0.0, noise = 0.0;
  };
  const auto region_of = [&](int x, int y, int k) {
    const int before = k == 0 ? 0 : 1 << (k - 1), size = 1 << k;
    double count = 0.0, v = 0.0, mean = 0.0, n = 0.0, c2 = 0.0, noise = 0.0;
    for (int py = y - before; py < y - before + size; ++py) {
      for (int px = x - before; px < x - before + size; ++px) {
        if (px < 0 || py < 0 || px >= width || py >= height) continue;
        count += 1.0;
        v += input.variance(px, py);
        noise += cautious(px, py);
        mean += input.mean(px, py);
        n += input.n(px, py);
        if (options.variance == SizeVariance::kContrast) {
          c2 += contrast(input.minimum(px, py), input.maximum(px, py), input.n(px, py));
        }
      }
    }
    Region r;
    r.samples = n / count;
    r.noise = noise / (count * count);
    r.q = options.coarse == SizeCoarse::kPyramid && k > 0
              ? input.coarse[static_cast<std::size_t>(k)](x, y)
              : mean / count;
    if (options.variance == SizeVariance::kCoarseVariance) {
      r.s = v / (count * count);
    } else {
      r.s = c2 / count;
    }
    return r;
  };
  const auto factor = [&](int x, int y, int k, const Region& fine, const Region& coarse) {
    switch (options.factor.rule) {
      case SizeFactorRule::kConstant:
        return options.factor.constant;
      case SizeFactorRule::kGreedy: {
        const double n = k == 0 ? fine.samples : coarse.samples;
        return (k == 0 ? 1.0 : 5.0 / 3.0) * -std::log(1.0 - std::pow(1.9 * 0.2, std::sqrt(0.5))) *
               (1.0 - 1.0 / std::fmax(n, 1.0001));
      }
      default:
        break;
    }
    if (input.attenuation.empty()) return 0.10;
    const int first = k == 0 && !options.track_a0 ? 1 : k;
    const double a = input.attenuation[static_cast<std::size_t>(first)](x, y);
    const double b = input.attenuation[static_cast<std::size_t>(k) + 1](x, y);
    if (a + b == 0.0 || (a == 1.0 && b == 1.0)) return options.factor_fallback;
    const double w = std::abs(a - b) / (a + b);
    if (options.factor.rule == SizeFactorRule::kInverse) return std::fmin(1.0 / w, 1e6);
    if (options.factor.rule == SizeFactorRule::kLiteral) return w;
    return std::fmin(std::fmax(w, 0.05), 0.30);
  };

  FilterSizes result;
  result.level = CountImage(width, height, input.levels);
  for (int k = input.levels - 1; k >= 0; --k) {
    Plane t(width, height), stop(width, height), beyond(width, height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const Region fine = region_of(x, y, k), coarse = region_of(x, y, k + 1);
        const double dq = coarse.q - fine.q;
        t(x, y) = coarse.s - fine.s + factor(x, y, k, fine, coarse) * dq * dq;
        stop(x, y) = t(x, y) > 0.0 || !std::isfinite(t(x, y)) ? 1.0 : 0.0;
        beyond(x, y) = -INFINITY;
        for (int qy = y; qy <= std::min(y + 1, height - 1); ++qy) {
          for (int qx = x; qx <= std::min(x + 1, width - 1); ++qx) {
            const Region next = region_of(qx, qy, k + 1);
            const double d = next.q - fine.q, z2 = options.evidence * options.evidence;
            beyond(x, y) = std::fmax(beyond(x, y), d * d - z2 * (next.noise + 0.5 * fine.noise));
          }
        }
      }
    }
    const Plane vote = votes(stop, k, options.smooth);
    for (std::size_t i = 0; i < stop.size(); ++i) {
      if (stops(stop[i], vote[i], beyond[i], options)) result.level[i] = k;
    }
    result.t.insert(result.t.begin(), t);
    result.vote.insert(result.vote.begin(), vote);
    result.beyond.insert(result.beyond.begin(), beyond);
  }
  return result;
}

// Sizes that lie at most `step` above their neighbours' least.
inline CountImage limited_steps(const CountImage& level, int step) {
  CountImage limited = level;
  for (int y = 0; y < level.height(); ++y) {
    for (int x = 0; x < level.width(); ++x) {
      for (int d = 0; d < 9; ++d) {
        const int qx = x + d % 3 - 1, qy = y + d / 3 - 1;
        if (qx < 0 || qy < 0 || qx >= level.width() || qy >= level.height()) continue;
        if (level(qx, qy) + step < limited(x, y)) limited(x, y) = level(qx, qy) + step;
      }
    }
  }
  return limited;
}

}  // namespace spool::reference
