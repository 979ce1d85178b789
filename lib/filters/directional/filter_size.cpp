#include "lib/filters/directional/filter_size.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/pyramid/convolution.h"
#include "lib/pyramid/region_mean.h"
#include "lib/statistics/contrast.h"

namespace spool {
namespace {

constexpr double kLargestInverseFactor = 1e6;
constexpr double kLeastSamples = 1.0001;  // keeps 1 - 1/N above zero: else no size ever stops
constexpr double kOwnVote = 0.01;         // weight that a piece keeps in its neighbours' vote
constexpr double kHalf = 0.5 - 1e-9;      // a tie at a straight border must not hang on rounding

template <class Body>
void for_rows(const Plane& like, GuardCounts& guards, Body&& body) {
  std::vector<GuardCounts> rows(static_cast<std::size_t>(like.height()));
  parallel_rows(0, like.height(), [&](int y) { body(y, rows[static_cast<std::size_t>(y)]); });
  for (const GuardCounts& row : rows)
    guards += row;
}

// Squared contrast of the extremes over R_k, and 0 where the region has fewer than two samples.
Plane region_contrast(const FilterSizeInput& input, int level, ContrastForm form,
                      GuardCounts& guards) {
  Plane contrast(input.mean.width(), input.mean.height());
  for_rows(contrast, guards, [&](int y, GuardCounts& caught) {
    for (int x = 0; x < contrast.width(); ++x) {
      const Rectangle r = region(x, y, level, contrast.bounds());
      double low = std::numeric_limits<double>::infinity(), high = -low;
      long long samples = 0;
      for (int py = r.y0; py < r.y1; ++py) {
        for (int px = r.x0; px < r.x1; ++px) {
          low = std::min(low, input.minimum(px, py));
          high = std::max(high, input.maximum(px, py));
          samples += input.n(px, py);
        }
      }
      if (samples >= 2) contrast(x, y) = squared_contrast(low, high, form, caught);
    }
  });
  return contrast;
}

// S_k; `contrast` is that of the pieces, for the means of contrast.
Plane size_variance(const FilterSizeInput& input, int k, const Plane& contrast,
                    const FilterSizeOptions& options, GuardCounts& guards) {
  if (options.variance == SizeVariance::kContrast) {
    return k > 0 && options.contrast_region == ContrastRegion::kRegionMinMax
               ? region_contrast(input, k, options.contrast, guards)
               : region_mean(contrast, k);
  }
  Plane sum = region_sum(input.variance, k);
  parallel_rows(0, sum.height(), [&](int y) {
    for (int x = 0; x < sum.width(); ++x) {
      const double count = region_count(x, y, k, sum.bounds());
      sum(x, y) /= count * count;
    }
  });
  return sum;
}

// w of eq 9 from two values of the attenuation.
double attenuation_factor(double a_fine, double a_coarse, const FilterSizeOptions& options,
                          GuardCounts& caught) {
  const double sum = a_fine + a_coarse;
  const bool never_updated = a_fine == 1.0 && a_coarse == 1.0;
  if (!(sum > 0.0) || never_updated) {
    caught.add(Guard::kSizeFactorFallback);
    return options.factor_fallback;
  }
  const double difference = std::abs(a_fine - a_coarse);
  if (options.factor.rule == SizeFactorRule::kInverse) {
    const double w = sum / difference;
    if (w <= kLargestInverseFactor) return w;
    caught.add(Guard::kSizeFactorClamped);
    return kLargestInverseFactor;
  }
  const double w = difference / sum;
  if (options.factor.rule == SizeFactorRule::kLiteral) return w;
  if (w < options.factor_min || w > options.factor_max) caught.add(Guard::kSizeFactorClamped);
  return std::clamp(w, options.factor_min, options.factor_max);
}

Plane size_factors(const FilterSizeInput& input, int k, const FilterSizeOptions& options,
                   GuardCounts& guards) {
  const int width = input.mean.width(), height = input.mean.height();
  if (options.factor.rule == SizeFactorRule::kConstant) {
    return Plane(width, height, options.factor.constant);
  }
  Plane w(width, height);
  if (options.factor.rule == SizeFactorRule::kGreedy) {
    // Samples that the comparison rests on: the piece's own, then the mean over the coarser region.
    Plane samples(width, height);
    for (std::size_t i = 0; i < samples.size(); ++i)
      samples[i] = input.n[i];
    if (k > 0) samples = region_mean(samples, k + 1);
    const double scale = (k > 0 ? 5.0 / 3.0 : 1.0) * greedy_caution(options.gamma);
    for (std::size_t i = 0; i < samples.size(); ++i)
      w[i] = scale * (1.0 - 1.0 / std::max(samples[i], kLeastSamples));
    return w;
  }
  if (static_cast<int>(input.attenuation.size()) <= k + 1) {
    guards.add(Guard::kSizeFactorFallback, w.size());
    return Plane(width, height, 0.10);  // a bare selection: no attenuation was ever defined
  }
  const std::size_t fine = k == 0 && !options.track_a0 ? 1 : static_cast<std::size_t>(k);
  const Plane& a_fine = input.attenuation[fine];
  const Plane& a_coarse = input.attenuation[static_cast<std::size_t>(k) + 1];
  for_rows(w, guards, [&](int y, GuardCounts& caught) {
    for (int x = 0; x < width; ++x)
      w(x, y) = attenuation_factor(a_fine(x, y), a_coarse(x, y), options, caught);
  });
  return w;
}

// Replaces the votes stop_k of the pieces by the decision after their neighbours have voted.
void smooth_stops(Plane& stop, int k, SizeSmooth rule) {
  if (rule == SizeSmooth::kOff) return;
  const double sigma = std::max(0.8, 0.7 * std::ldexp(1.0, k));
  const Taps taps = gaussian_taps(sigma);
  const double middle = taps.values[static_cast<std::size_t>(-taps.first)];
  const double own = std::max(0.0, middle * middle - kOwnVote);
  const Plane vote = convolve(stop, taps);
  parallel_rows(0, stop.height(), [&](int y) {
    for (int x = 0; x < stop.width(); ++x) {
      if (rule == SizeSmooth::kOn) {
        stop(x, y) = vote(x, y) >= kHalf ? 1.0 : 0.0;
      } else {
        const double others = (vote(x, y) - own * stop(x, y)) / (1.0 - own);
        stop(x, y) = stop(x, y) > 0.0 && others >= kHalf ? 1.0 : 0.0;
      }
    }
  });
}

// Where a region is symmetric about a clean edge its mean does not change with its size, and no
// size stops: a lone large filter on the edge. Its neighbours see the edge.
CountImage limited_steps(const CountImage& level, int step) {
  CountImage limited = level;
  parallel_rows(0, level.height(), [&](int y) {
    for (int x = 0; x < level.width(); ++x) {
      const Rectangle near = grow({x, y, x + 1, y + 1}, 1, 1, 1, 1, level.bounds());
      for (int qy = near.y0; qy < near.y1; ++qy) {
        for (int qx = near.x0; qx < near.x1; ++qx)
          limited(x, y) = std::min(limited(x, y), level(qx, qy) + step);
      }
    }
  });
  return limited;
}

void add_view(Views* views, const char* family, int k, const Plane& image) {
  if (views) views->add(fmt::format("{}.{}", family, k), image);
}

}  // namespace

double greedy_caution(double gamma) {
  return -std::log(1.0 - std::pow(1.9 * gamma, 1.0 / std::sqrt(2.0)));
}

CountImage filter_size(const FilterSizeInput& input, const FilterSizeOptions& options, Views* views,
                       GuardCounts& guards) {
  return filter_size(std::span(&input, 1), options, views, guards);
}

CountImage filter_size(std::span<const FilterSizeInput> inputs, const FilterSizeOptions& options,
                       Views* views, GuardCounts& guards) {
  const FilterSizeInput& first = inputs.front();
  const int width = first.mean.width(), height = first.mean.height();
  CountImage level(width, height, first.levels);
  const auto view_name = [&](const char* family, int k, std::size_t i) {
    return inputs.size() == 1 ? fmt::format("{}.{}", family, k)
                              : fmt::format("{}.{}.{}", family, k, i);
  };

  std::vector<Plane> contrast(inputs.size());  // of the pieces, where it is asked for
  std::vector<Plane> s, fine;                  // S_k and q_k of each signal
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (options.variance == SizeVariance::kContrast) {
      contrast[i] = region_contrast(inputs[i], 0, options.contrast, guards);
    }
    s.push_back(size_variance(inputs[i], 0, contrast[i], options, guards));
    fine.push_back(inputs[i].mean);
    if (views) views->add(view_name("S", 0, i), s[i]);
    if (views) views->add(view_name("q", 0, i), fine[i]);
  }
  for (int k = 0; k < first.levels; ++k) {
    const auto next = static_cast<std::size_t>(k) + 1;
    const Plane w = size_factors(first, k, options, guards);

    // T_k [LiuZheng (9)]
    Plane t(width, height), stop(width, height);
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      Plane s_next = size_variance(inputs[i], k + 1, contrast[i], options, guards);
      Plane coarse = options.coarse == SizeCoarse::kLaplace ? inputs[i].coarse[next]
                                                            : region_mean(inputs[i].mean, k + 1);
      parallel_rows(0, height, [&](int y) {
        for (int x = 0; x < width; ++x) {
          const double dq = coarse(x, y) - fine[i](x, y);
          t(x, y) += s_next(x, y) - s[i](x, y) + w(x, y) * dq * dq;
        }
      });
      if (views) views->add(view_name("S", k + 1, i), s_next);
      if (views) views->add(view_name("q", k + 1, i), coarse);
      s[i] = std::move(s_next);
      fine[i] = std::move(coarse);
    }
    for_rows(t, guards, [&](int y, GuardCounts& caught) {
      for (int x = 0; x < width; ++x) {
        t(x, y) /= static_cast<double>(inputs.size());
        const bool finite = std::isfinite(t(x, y));
        if (!finite) caught.add(Guard::kSizeNotFinite);
        stop(x, y) = !finite || t(x, y) > 0.0 ? 1.0 : 0.0;
      }
    });
    smooth_stops(stop, k, options.smooth);
    parallel_rows(0, height, [&](int y) {
      for (int x = 0; x < width; ++x) {
        if (stop(x, y) > 0.0) level(x, y) = std::min(level(x, y), k);
      }
    });
    add_view(views, "w", k, w);
    add_view(views, "T", k, t);
    add_view(views, "stop", k, stop);
  }
  return options.step > 0 ? limited_steps(level, options.step) : level;
}

}  // namespace spool
