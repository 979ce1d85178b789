#include "lib/sampling/multiscale/step_blocks.h"

#include <algorithm>

#include "lib/pyramid/region_mean.h"
#include "lib/sampling/multiscale/attenuation.h"

namespace spool {

BlockGrid::BlockGrid(const Rectangle& bounds)
    : bounds_(bounds),
      across_((bounds.width() + kBlockSide - 1) / kBlockSide),
      down_((bounds.height() + kBlockSide - 1) / kBlockSide) {}

Rectangle BlockGrid::operator[](std::size_t i) const {
  const int x = static_cast<int>(i) % across_ * kBlockSide;
  const int y = static_cast<int>(i) / across_ * kBlockSide;
  return intersect({x, y, x + kBlockSide, y + kBlockSide}, bounds_);
}

void BlockGrid::add(const Rectangle& r, std::vector<Rectangle>& boxes) const {
  if (r.empty()) return;
  const int bx1 = (r.x1 - 1) / kBlockSide, by1 = (r.y1 - 1) / kBlockSide;
  for (int by = r.y0 / kBlockSide; by <= by1; ++by) {
    for (int bx = r.x0 / kBlockSide; bx <= bx1; ++bx) {
      const std::size_t i = static_cast<std::size_t>(by) * across_ + bx;
      boxes[i] = unite(boxes[i], intersect(r, (*this)[i]));
    }
  }
}

StepBlocks::StepBlocks(const Board& board, const BlockGrid& grid, const StepReach& reach,
                       std::span<const Pick> picks, const MultiscaleOptions& options)
    : changed(grid.size()),
      coarse(reach.coarse.size(), Boxes(grid.size())),
      detail(reach.detail.size(), Boxes(grid.size())),
      variance(static_cast<std::size_t>(options.levels()) + 1, Boxes(grid.size())),
      attenuation(variance.size(), Boxes(grid.size())),
      priority(variance.size(), Boxes(grid.size())) {
  for (const Pick& pick : picks) {
    Rectangle& box = changed[grid.block_of(pick.x, pick.y)];
    box = unite(box, {pick.x, pick.y, pick.x + 1, pick.y + 1});
  }
  const Rectangle bounds = board.bounds();
  const auto grown = [&](const Rectangle& r, int by) { return grow(r, by, by, by, by, bounds); };
  for (const Rectangle& source : changed) {
    if (source.empty()) continue;
    for (std::size_t k = 0; k < coarse.size(); ++k)
      grid.add(grown(source, reach.coarse[k]), coarse[k]);
    for (std::size_t k = 0; k < detail.size(); ++k)
      grid.add(grown(source, reach.detail[k]), detail[k]);
    for (int k = 0; k <= options.levels(); ++k) {
      const auto level = static_cast<std::size_t>(k);
      grid.add(attenuation_box(board, k, source, grown(source, reach.coarse[level]), options),
               attenuation[level]);
      if (k > 0) grid.add(region_influence(source, k, bounds), variance[level]);
    }
  }
  for (int k = 1; k <= options.levels(); ++k) {
    const auto level = static_cast<std::size_t>(k);
    const Boxes& of_detail = detail[static_cast<std::size_t>(detail_of_level(k, options))];
    for (std::size_t i = 0; i < grid.size(); ++i) {
      Rectangle box = unite(variance[level][i], attenuation[level][i]);
      box = unite(box, of_detail[i]);
      if (options.detail_norm == DetailNorm::kRelative) box = unite(box, coarse[level][i]);
      priority[level][i] = intersect(box, board.area);
    }
  }
}

}  // namespace spool
