// The attenuation A of eqs 7 and 8: how much the coarse values of a region still change.
//
//   F_k = |f_k - f_k before the step|                              [LiuZheng (8)]
//   A_k = (1 - w) A_k + w F_k / c,  w = 1 - (1 - alpha)^c          [LiuZheng (7)]
//
// with c = new samples in the region / max(1, its unsaturated pieces before the step): w composes,
// so two half passes weigh as much as one. The equations are missing from the text; the other
// readings are options. Slow twin: tests/reference/multiscale_reference.h.
#pragma once

#include <utility>
#include <vector>

#include "lib/core/rectangle.h"
#include "lib/sampling/multiscale/board.h"
#include "lib/sampling/multiscale/region_counts.h"

namespace spool {

// A_0 .. A_K before the first step: 1.
template <class T>
void start_attenuation(ScalarAnalysis<T>& scalar, const Rectangle& window,
                       const MultiscaleOptions& options) {
  const auto count = static_cast<std::size_t>(options.levels()) + 1;
  scalar.attenuation.assign(count, Image<T>(window.width(), window.height(), T{1}));
}

// Eq 7 for one level: the new A of an entry whose region received `fresh` > 0 samples on `open` >=
// 0 unsaturated pieces. Not for several threads at once: it remembers powers.
class AttenuationStep {
 public:
  AttenuationStep(int level, const MultiscaleOptions& options);
  double operator()(double attenuation, double change, int fresh, int open);

  double kept(int fresh, int open);  // (1 - alpha)^(fresh / open)

 private:
  AttenuationUpdate update_;
  double alpha_;
  int whole_region_;                // pieces of a region that no border cuts
  std::vector<double> whole_kept_;  // kept(m, whole_region_) at [m]; negative: not yet known
};

// Entries of level k whose attenuation a step may change, when the fresh samples lie in `changed`
// and f_k changed inside `coarse_box`.
Rectangle attenuation_box(const ExactBoard& board, int k, const Rectangle& changed,
                          const Rectangle& coarse_box, const MultiscaleOptions& options);

// Updates A_k on the rows of `box`, when the board knows what is fresh and the step is not yet
// ended. Several threads may update different rows.
class AttenuationRows {
 public:
  AttenuationRows(const ExactBoard& board, int k, const Rectangle& box,
                  const MultiscaleOptions& options);
  // Row y of the box from f_k after and before the step; all three start at column box.x0.
  void update(int y, const double* now, const double* before, double* attenuation,
              AttenuationStep& step) const;
  bool changes_nothing() const { return most_ == 0 && !any_touch_; }

 private:
  std::pair<int, int> whole_regions(int y) const;

  const ExactBoard& board_;
  int level_;
  Rectangle box_;
  bool any_touch_;
  RegionCounts counts_;
  int most_;  // fresh samples of a region
  // (1 - alpha)^c and c of whole regions with m fresh samples at [m]; empty where the rule is
  // another or a piece ran out, so that rows cannot be updated as a whole.
  std::vector<double> kept_, passes_;
};

// Updates A_k of a scalar on `box`; before(x, y) is f_k before the step, an image whose (0, 0) is
// (box.x0, box.y0).
void update_attenuation(ExactBoard& board, ScalarAnalysis<double>& scalar, int k,
                        const Rectangle& box, const Plane& before,
                        const MultiscaleOptions& options);

}  // namespace spool
