#include "lib/sampling/multiscale/attenuation.h"

#include <algorithm>
#include <cmath>

#include "lib/core/vector_clones.h"
#include "lib/pyramid/region_mean.h"
#include "lib/pyramid/row_loop.h"

namespace spool {

AttenuationStep::AttenuationStep(int level, const MultiscaleOptions& options)
    : update_(options.attenuation),
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
      return old_weight * attenuation + (1.0 - old_weight) * (change / c);
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

Rectangle attenuation_box(const ExactBoard& board, int k, const Rectangle& changed,
                          const Rectangle& coarse_box, const MultiscaleOptions& options) {
  if (options.attenuation == AttenuationUpdate::kNone) return {};
  if (options.attenuation == AttenuationUpdate::kAnyTouch) return intersect(coarse_box, board.area);
  return intersect(region_influence(changed, k, board.bounds()), board.area);
}

namespace {

// Eq 7 for a row of entries whose regions are whole and open, with `fractional`: kept[m] and
// passes[m] for m fresh samples. Where none is fresh A stays.
SPOOL_VECTOR_CLONES
void step_row(const std::int32_t* fresh, const double* kept, const double* passes, const double* f,
              const double* before, int width, double* __restrict attenuation) {
  constexpr int kGroup = 16;  // entries of which often none is fresh
  for (int x0 = 0; x0 < width; x0 += kGroup) {
    const int n = width - x0 < kGroup ? width - x0 : kGroup;
    std::int32_t any = 0;
    for (int i = 0; i < n; ++i)
      any |= fresh[x0 + i];
    if (any == 0) continue;
    for (int x = x0; x < x0 + n; ++x) {
      const double change = std::abs(f[x] - before[x]);  // eq 8
      const double weight = kept[fresh[x]];
      const double next = weight * attenuation[x] + (1.0 - weight) * (change / passes[fresh[x]]);
      attenuation[x] = fresh[x] == 0 ? attenuation[x] : next;
    }
  }
}

}  // namespace

AttenuationRows::AttenuationRows(const ExactBoard& board, int k, const Rectangle& box,
                                 const MultiscaleOptions& options)
    : board_(board),
      level_(k),
      box_(box),
      any_touch_(options.attenuation == AttenuationUpdate::kAnyTouch),
      counts_(board, k, box),
      most_(counts_.largest_fresh()) {
  const bool in_rows = options.attenuation == AttenuationUpdate::kFractional && counts_.all_open();
  if (!in_rows) return;
  const int whole = 1 << (2 * k);
  AttenuationStep table(k, options);
  for (int m = 0; m <= most_; ++m) {
    kept_.push_back(table.kept(m, whole));
    passes_.push_back(m == 0 ? 1.0 : static_cast<double>(m) / whole);
  }
}

// Columns of the box whose regions no border of the area cuts; none when row y's are cut.
std::pair<int, int> AttenuationRows::whole_regions(int y) const {
  const Rectangle& area = board_.area;
  const int before = level_ == 0 ? 0 : 1 << (level_ - 1), after = level_ == 0 ? 0 : before - 1;
  if (y - before < area.y0 || y + after >= area.y1) return {box_.x0, box_.x0};
  const int x0 = std::clamp(area.x0 + before, box_.x0, box_.x1);
  return {x0, std::clamp(area.x1 - after, x0, box_.x1)};
}

void AttenuationRows::update(int y, const double* now, const double* before, double* attenuation,
                             AttenuationStep& step) const {
  const auto each = [&](int begin, int end) {
    for (int x = begin; x < end; ++x) {
      const int i = x - box_.x0, fresh = counts_.fresh(x, y);
      if (fresh == 0 && !any_touch_) continue;
      const double change = std::abs(now[i] - before[i]);  // eq 8
      if (change > 0.0 || !any_touch_) {
        attenuation[i] = step(attenuation[i], change, fresh, counts_.open(x, y));  // eq 7
      }
    }
  };
  const auto [begin, end] = kept_.empty() ? std::pair{box_.x0, box_.x0} : whole_regions(y);
  each(box_.x0, begin);
  if (begin < end) {
    const int i = begin - box_.x0;
    step_row(counts_.fresh_row(begin, y), kept_.data(), passes_.data(), now + i, before + i,
             end - begin, attenuation + i);
  }
  each(end, box_.x1);
}

void update_attenuation(ExactBoard& board, ScalarAnalysis<double>& scalar, int k,
                        const Rectangle& box, const Plane& before,
                        const MultiscaleOptions& options) {
  if (box.empty()) return;
  const Plane& f = scalar.pyramid.coarse[static_cast<std::size_t>(k)];
  Plane& attenuation = scalar.attenuation[static_cast<std::size_t>(k)];
  const AttenuationRows rows(board, k, box, options);
  if (rows.changes_nothing()) return;
  constexpr int kBand = 16;  // rows that share one table of powers
  const int bands = (box.height() + kBand - 1) / kBand;
  rows_by_area(0, bands, box.area(), [&](int band) {
    AttenuationStep step(k, options);
    const int first = box.y0 + band * kBand;
    for (int y = first; y < std::min(first + kBand, box.y1); ++y)
      rows.update(y, &f(box.x0, y), &before(0, y - box.y0), &attenuation(box.x0, y), step);
  });
}

}  // namespace spool
