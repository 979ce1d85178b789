// update=exact: a step is one region, after which exactly what it changed is recomputed, and
// nothing else: bit for bit the full analysis.
#pragma once

#include <memory>
#include <vector>

#include "lib/core/guards.h"
#include "lib/core/rectangle.h"
#include "lib/sampling/multiscale/board.h"
#include "lib/sampling/multiscale/update.h"

namespace spool {

// Where a step inside `changed` matters, and the coarse values there before it.
struct BeforeStep {
  Rectangle changed;                         // of the window
  std::vector<Rectangle> coarse_boxes;       // per level 0 .. K: where f_k changes
  std::vector<Rectangle> detail_boxes;       // per d_k
  std::vector<Rectangle> attenuation_boxes;  // per level 0 .. K
  std::vector<std::vector<Plane>> coarse;    // [scalar][k]: f_k on its attenuation box
};

BeforeStep remember(const ExactBoard& board, const Rectangle& changed,
                    const MultiscaleOptions& options);

// After samples were taken and loaded inside step.changed: f, d, V and A.
void update_analysis(ExactBoard& board, const BeforeStep& step, const MultiscaleOptions& options);

// Where P_1 .. P_K must be computed again after that.
std::vector<Rectangle> priority_boxes(const ExactBoard& board, const BeforeStep& step,
                                      const MultiscaleOptions& options);

std::unique_ptr<Update> exact_update(ExactBoard& board, const MultiscaleOptions& options);

}  // namespace spool
