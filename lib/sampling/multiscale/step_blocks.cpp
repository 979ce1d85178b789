#include "lib/sampling/multiscale/step_blocks.h"

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

std::vector<Rectangle> BlockGrid::changed(std::span<const Pick> picks, int reach) const {
  std::vector<Rectangle> sampled(size()), boxes(size());
  for (const Pick& pick : picks) {
    Rectangle& box = sampled[block_of(pick.x, pick.y)];
    box = unite(box, {pick.x, pick.y, pick.x + 1, pick.y + 1});
  }
  for (const Rectangle& source : sampled) {
    if (!source.empty()) add(grow(source, reach, reach, reach, reach, bounds_), boxes);
  }
  return boxes;
}

}  // namespace spool
