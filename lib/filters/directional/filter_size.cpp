#include "lib/filters/directional/filter_size.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "lib/core/parallel.h"
#include "lib/filters/directional/stop_votes.h"
#include "lib/pyramid/region_mean.h"
#include "lib/statistics/contrast.h"

namespace spool {
namespace {

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
  return variance_over_region(input.variance, k);
}

// Where a region is symmetric about a clean edge its mean does not change with its size, and no
// size stops: a lone large filter on the edge. What its neighbours chose holds it; one pass, as the
// presets were tuned with it: a size may end more than a step above one that was limited, too.
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

  // Adds what this signal, one of `signals`, says of the step to level k + 1 and goes there.
  void add_step(int k, const Plane& w, std::size_t signals, SizeCriterion& criterion) {
    Plane s = size_variance(input_, k + 1, contrast_, options_.variance);
    Plane q = options_.coarse == SizeCoarse::kPyramid
                  ? input_.coarse[static_cast<std::size_t>(k) + 1]
                  : region_mean(input_.mean, k + 1);
    Plane noise;
    if (options_.evidence > 0.0) {
      if (k == 0) noise_ = cautious_ = cautious_variance(input_.variance);
      noise = variance_over_region(cautious_, k + 1);
    }
    spool::add_step({s_, s, q_, q, noise_, noise}, w, signals, options_.evidence, criterion);
    noise_ = std::move(noise);
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
  Plane contrast_;          // of the pieces, where it is asked for
  Plane s_, q_;             // S_k and q_k
  Plane cautious_, noise_;  // cautious variances of the pieces, and of the mean over R_k
};

}  // namespace

Plane variance_over_region(const Plane& variance, int k) {
  Plane sum = region_sum(variance, k);
  std::vector<double> columns;  // of the region around x
  for (int x = 0; x < sum.width(); ++x)
    columns.push_back(region(x, 0, k, sum.bounds()).width());
  parallel_rows(0, sum.height(), [&](int y) {
    const int rows = region(0, y, k, sum.bounds()).height();
    double* const of_row = sum.row(y).data();
    for (int x = 0; x < sum.width(); ++x) {
      const double count = columns[static_cast<std::size_t>(x)] * rows;
      of_row[x] /= count * count;
    }
  });
  return sum;
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
    SizeCriterion criterion;
    for (SizeSignal& signal : signals)
      signal.add_step(k, w, signals.size(), criterion);
    const Plane stop = decide_stops(criterion, k, options.smooth, guards);
    parallel_rows(0, height, [&](int y) {
      for (int x = 0; x < width; ++x) {
        if (stop(x, y) > 0.0) level(x, y) = std::min(level(x, y), k);
      }
    });
    if (!views) continue;
    views->add(fmt::format("w.{}", k), w);
    views->add(fmt::format("T.{}", k), criterion.t);
    views->add(fmt::format("stop.{}", k), stop);
  }
  return options.step > 0 ? limited_steps(level, options.step) : level;
}

}  // namespace spool
