// Slow twin of lib/filters/directional/filter_size.h: every region summed by itself.
#pragma once

#include <cmath>
#include <vector>

#include "lib/core/extend.h"
#include "lib/filters/directional/filter_size.h"

namespace spool::reference {

struct FilterSizes {
  CountImage level;
  std::vector<Plane> t;     // T_k
  std::vector<Plane> vote;  // blurred votes, own one out where the rule says so
};

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
  struct Region {
    double s = 0.0, q = 0.0, samples = 0.0;
  };
  const auto region_of = [&](int x, int y, int k) {
    const int before = k == 0 ? 0 : 1 << (k - 1), size = 1 << k;
    double count = 0.0, v = 0.0, mean = 0.0, n = 0.0, c2 = 0.0;
    for (int py = y - before; py < y - before + size; ++py) {
      for (int px = x - before; px < x - before + size; ++px) {
        if (px < 0 || py < 0 || px >= width || py >= height) continue;
        count += 1.0;
        v += input.variance(px, py);
        mean += input.mean(px, py);
        n += input.n(px, py);
        if (options.variance == SizeVariance::kContrast) {
          c2 += contrast(input.minimum(px, py), input.maximum(px, py), input.n(px, py));
        }
      }
    }
    Region r;
    r.samples = n / count;
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
    Plane t(width, height), stop(width, height), vote(width, height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const Region fine = region_of(x, y, k), coarse = region_of(x, y, k + 1);
        const double dq = coarse.q - fine.q;
        t(x, y) = coarse.s - fine.s + factor(x, y, k, fine, coarse) * dq * dq;
        stop(x, y) = t(x, y) > 0.0 || !std::isfinite(t(x, y)) ? 1.0 : 0.0;
      }
    }
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
        bool stops = stop(x, y) > 0.0;
        if (options.smooth == SizeSmooth::kOn) stops = vote(x, y) >= 0.5 - 1e-9;
        if (options.smooth == SizeSmooth::kOpensOnly) {
          vote(x, y) = (vote(x, y) - own * stop(x, y)) / (1.0 - own);
          stops = stops && vote(x, y) >= 0.5 - 1e-9;
        }
        if (stops) result.level(x, y) = k;
      }
    }
    result.t.insert(result.t.begin(), t);
    result.vote.insert(result.vote.begin(), vote);
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
