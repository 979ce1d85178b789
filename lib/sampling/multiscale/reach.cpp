#include "lib/sampling/multiscale/reach.h"

#include <algorithm>
#include <vector>

#include "lib/sampling/multiscale/board.h"

namespace spool {
namespace {

// How far from a changed piece the images of each level change, in x and y alike.
struct StepReach {
  std::vector<int> coarse;  // of f_0, f_1, ...
  std::vector<int> detail;  // of d_0, d_1, ...
};

StepReach step_reach(const MultiscaleOptions& options) {
  // Far from every border. A change near one is mirrored, and then acts to the other side: so the
  // larger of both sides counts for both.
  constexpr int kFar = 1 << 14;
  std::vector<Rectangle> coarse, detail;
  pyramid_influence({kFar, kFar, kFar + 1, kFar + 1}, {0, 0, 2 * kFar, 2 * kFar},
                    board_pyramid(options), coarse, detail);
  const auto reach_of = [](const Rectangle& box) {
    return std::max(kFar - box.x0, box.x1 - 1 - kFar);
  };
  StepReach reach;
  for (const Rectangle& box : coarse)
    reach.coarse.push_back(reach_of(box));
  for (const Rectangle& box : detail)
    reach.detail.push_back(reach_of(box));
  return reach;
}

}  // namespace

Rectangle analysis_window(const Rectangle& area, const Rectangle& bounds,
                          const MultiscaleOptions& options) {
  const StepReach step = step_reach(options);
  int reach = 1 << (options.levels() - 1);
  for (const std::vector<int>* of : {&step.coarse, &step.detail})
    reach = std::max(reach, *std::max_element(of->begin(), of->end()));
  Rectangle window = grow(area, reach, reach, reach, reach, bounds);
  const int lattice = 1 << (options.levels() + 1);  // phase00 counts phases from the corner
  window.x0 -= window.x0 % lattice;
  window.y0 -= window.y0 % lattice;
  return window;
}

}  // namespace spool
