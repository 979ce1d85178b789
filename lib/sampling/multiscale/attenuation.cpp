#include "lib/sampling/multiscale/attenuation.h"

#include <algorithm>
#include <cmath>

#include "lib/pyramid/region_mean.h"
#include "lib/pyramid/row_loop.h"
#include "lib/sampling/multiscale/region_counts.h"

namespace spool {

void start_attenuation(ScalarAnalysis& scalar, const Rectangle& window, const Plane* before_last,
                       const MultiscaleOptions& options) {
  const auto count = static_cast<std::size_t>(options.levels()) + 1;
  scalar.attenuation.assign(count, Plane(window.width(), window.height(), 1.0));
  if (before_last == nullptr) return;
  Plane f0(window.width(), window.height());
  for (int y = 0; y < f0.height(); ++y) {
    for (int x = 0; x < f0.width(); ++x)
      f0(x, y) = (*before_last)(x + window.x0, y + window.y0);
  }
  const Pyramid before = build_pyramid(f0, options.pyramid);
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t i = 0; i < f0.size(); ++i)
      scalar.attenuation[k][i] = std::abs(scalar.pyramid.coarse[k][i] - before.coarse[k][i]);
  }
}

AttenuationStep::AttenuationStep(int level, const MultiscaleOptions& options)
    : update_(options.attenuation),
      scale_(options.change_scale),
      alpha_(options.alpha),
      whole_region_(1 << (2 * level)),
      whole_kept_(static_cast<std::size_t>(whole_region_) + 1, -1.0) {}

double AttenuationStep::kept(int fresh, int open) {
  const auto power = [&] { return std::pow(1.0 - alpha_, static_cast<double>(fresh) / open); };
  if (open != whole_region_ || fresh > whole_region_) return power();
  double& known = whole_kept_[static_cast<std::size_t>(fresh)];
  if (known < 0.0) known = power();
  return known;
}

double AttenuationStep::operator()(double attenuation, double change, int fresh, int open) {
  switch (update_) {
    case AttenuationUpdate::kFractional: {
      open = std::max(open, 1);
      const double c = static_cast<double>(fresh) / open;
      const double old_weight = kept(fresh, open);
      double scaled = change;
      if (scale_ == ChangeScale::kPerPass) scaled = change / c;
      if (scale_ == ChangeScale::kSqrt) scaled = change / std::sqrt(c);
      return old_weight * attenuation + (1.0 - old_weight) * scaled;
    }
    case AttenuationUpdate::kRegion:
    case AttenuationUpdate::kAnyTouch:
      return (1.0 - alpha_) * attenuation + alpha_ * change;
    case AttenuationUpdate::kAccumulate:
      return alpha_ * attenuation + change;
    case AttenuationUpdate::kNone:
      break;
  }
  return attenuation;
}

Rectangle attenuation_box(const Board& board, int k, const Rectangle& changed,
                          const Rectangle& coarse_box, const MultiscaleOptions& options) {
  if (options.attenuation == AttenuationUpdate::kNone) return {};
  if (options.attenuation == AttenuationUpdate::kAnyTouch) return intersect(coarse_box, board.area);
  return intersect(region_influence(changed, k, board.bounds()), board.area);
}

void update_attenuation(Board& board, ScalarAnalysis& scalar, int k, const Rectangle& box,
                        const Plane& before, const MultiscaleOptions& options) {
  if (box.empty()) return;
  const Plane& f = scalar.pyramid.coarse[static_cast<std::size_t>(k)];
  Plane& attenuation = scalar.attenuation[static_cast<std::size_t>(k)];
  const bool any_touch = options.attenuation == AttenuationUpdate::kAnyTouch;
  const RegionCounts counts(board, k, box);
  constexpr int kBand = 16;  // rows that share one table of powers
  const int bands = (box.height() + kBand - 1) / kBand;
  rows_by_area(0, bands, box.area(), [&](int band) {
    AttenuationStep step(k, options);
    const int first = box.y0 + band * kBand;
    for (int y = first; y < std::min(first + kBand, box.y1); ++y) {
      for (int x = box.x0; x < box.x1; ++x) {
        const int fresh = counts.fresh(x, y);
        if (fresh == 0 && !any_touch) continue;
        const double change = std::abs(f(x, y) - before(x - box.x0, y - box.y0));  // eq 8
        if (change > 0.0 || !any_touch) {
          attenuation(x, y) = step(attenuation(x, y), change, fresh, counts.open(x, y));  // eq 7
        }
      }
    }
  });
}

}  // namespace spool
