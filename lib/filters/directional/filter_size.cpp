#include "lib/filters/directional/filter_size.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/pyramid/convolution.h"
#include "lib/pyramid/region_mean.h"
#include "lib/statistics/contrast.h"

namespace spool {
namespace {

constexpr double kLeastFactor = 0.05, kLargestFactor = 0.30;  // of literal_clamped
constexpr double kLargestInverseFactor = 1e6;
constexpr double kGreedyGamma = 0.2;
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

// Squared contrast of each piece's samples, and 0 where it has fewer than two.
Plane piece_contrast(const FilterSizeInput& input, ContrastForm form, GuardCounts& guards) {
  Plane contrast(input.mean.width(), input.mean.height());
  for_rows(contrast, guards, [&](int y, GuardCounts& caught) {
    for (int x = 0; x < contrast.width(); ++x) {
      if (input.n(x, y) < 2) continue;
      contrast(x, y) = squared_contrast(input.minimum(x, y), input.maximum(x, y), form, caught);
    }
  });
  return contrast;
}

// S_k; `contrast` is that of the pieces, for the means of contrast.
Plane size_variance(const FilterSizeInput& input, int k, const Plane& contrast,
                    SizeVariance variance) {
  if (variance == SizeVariance::kContrast) return region_mean(contrast, k);
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
  if (w < kLeastFactor || w > kLargestFactor) caught.add(Guard::kSizeFactorClamped);
  return std::clamp(w, kLeastFactor, kLargestFactor);
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
    const double scale = (k > 0 ? 5.0 / 3.0 : 1.0) * greedy_caution(kGreedyGamma);
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

// What one signal of the pieces says of T_k, level after level.
class SizeSignal {
 public:
  // `name`: what its views end in, "" or ".i".
  SizeSignal(const FilterSizeInput& input, const FilterSizeOptions& options, std::string name,
             Views* views, GuardCounts& guards)
      : input_(input), options_(options), name_(std::move(name)), views_(views) {
    if (options.variance == SizeVariance::kContrast)
      contrast_ = piece_contrast(input, options.contrast, guards);
    s_ = size_variance(input, 0, contrast_, options.variance);
    q_ = input.mean;
    show(0);
  }

  // Adds S_{k+1} - S_k + w_k (q_{k+1} - q_k)^2 to t and goes on to level k + 1 [LiuZheng (9)]
  void add_criterion(int k, const Plane& w, Plane& t) {
    Plane s = size_variance(input_, k + 1, contrast_, options_.variance);
    Plane q = options_.coarse == SizeCoarse::kPyramid
                  ? input_.coarse[static_cast<std::size_t>(k) + 1]
                  : region_mean(input_.mean, k + 1);
    parallel_rows(0, t.height(), [&](int y) {
      for (int x = 0; x < t.width(); ++x) {
        const double dq = q(x, y) - q_(x, y);
        t(x, y) += s(x, y) - s_(x, y) + w(x, y) * dq * dq;
      }
    });
    s_ = std::move(s);
    q_ = std::move(q);
    show(k + 1);
  }

 private:
  void show(int k) const {
    if (!views_) return;
    views_->add(fmt::format("S.{}{}", k, name_), s_);
    views_->add(fmt::format("q.{}{}", k, name_), q_);
  }

  const FilterSizeInput& input_;
  const FilterSizeOptions& options_;
  std::string name_;
  Views* views_;
  Plane contrast_;  // of the pieces, where it is asked for
  Plane s_, q_;     // S_k and q_k
};

// T_k, in place of the sum over `signals` signals; 1 where it wants to stop, else 0.
Plane stops_of(Plane& t, std::size_t signals, GuardCounts& guards) {
  Plane stop(t.width(), t.height());
  for_rows(t, guards, [&](int y, GuardCounts& caught) {
    for (int x = 0; x < t.width(); ++x) {
      t(x, y) /= static_cast<double>(signals);
      const bool finite = std::isfinite(t(x, y));
      if (!finite) caught.add(Guard::kSizeNotFinite);
      stop(x, y) = !finite || t(x, y) > 0.0 ? 1.0 : 0.0;
    }
  });
  return stop;
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
  std::vector<SizeSignal> signals;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::string name = inputs.size() == 1 ? "" : fmt::format(".{}", i);
    signals.emplace_back(inputs[i], options, name, views, guards);
  }
  CountImage level(width, height, first.levels);
  for (int k = 0; k < first.levels; ++k) {
    const Plane w = size_factors(first, k, options, guards);
    Plane t(width, height);
    for (SizeSignal& signal : signals)
      signal.add_criterion(k, w, t);
    Plane stop = stops_of(t, signals.size(), guards);
    smooth_stops(stop, k, options.smooth);
    parallel_rows(0, height, [&](int y) {
      for (int x = 0; x < width; ++x) {
        if (stop(x, y) > 0.0) level(x, y) = std::min(level(x, y), k);
      }
    });
    if (!views) continue;
    views->add(fmt::format("w.{}", k), w);
    views->add(fmt::format("T.{}", k), t);
    views->add(fmt::format("stop.{}", k), stop);
  }
  return options.step > 0 ? limited_steps(level, options.step) : level;
}

}  // namespace spool
