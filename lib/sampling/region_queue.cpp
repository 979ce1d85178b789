#include "lib/sampling/region_queue.h"

#include <algorithm>

namespace spool {
namespace {

constexpr int kBlock = 16;

int blocks_of(int n) {
  return (n + kBlock - 1) / kBlock;
}

Rectangle block_range(const Rectangle& r) {
  return {r.x0 / kBlock, r.y0 / kBlock, blocks_of(r.x1), blocks_of(r.y1)};
}

Rectangle extent_of(int bx, int by, const Rectangle& bounds) {
  return intersect({bx * kBlock, by * kBlock, (bx + 1) * kBlock, (by + 1) * kBlock}, bounds);
}

}  // namespace

RegionQueue::RegionQueue(int width, int height, int levels) : width_(width), height_(height) {
  SPOOL_CHECK_GE(levels, 1);
  const int bw = blocks_of(width), bh = blocks_of(height);
  for (int level = 0; level < levels; ++level) {
    blocks_.emplace_back(bw, bh);
    regions_.emplace_back(blocks_of(bw), blocks_of(bh));
  }
}

void RegionQueue::refresh(std::span<const Plane> priority, int level, const Rectangle& changed) {
  const auto l = static_cast<std::size_t>(level - 1);
  SPOOL_CHECK_LT(l, blocks_.size());
  const Plane& image = priority[l];
  SPOOL_CHECK_EQ(image.width(), width_);
  SPOOL_CHECK_EQ(image.height(), height_);
  if (changed.empty()) return;
  const Rectangle touched = block_range(changed);
  for (int by = touched.y0; by < touched.y1; ++by) {
    for (int bx = touched.x0; bx < touched.x1; ++bx) {
      const Rectangle extent = extent_of(bx, by, image.bounds());
      Maximum best;
      for (int y = extent.y0; y < extent.y1; ++y) {
        for (int x = extent.x0; x < extent.x1; ++x) {
          const Maximum entry{image(x, y), static_cast<std::uint32_t>(image.index(x, y))};
          if (larger(entry, best)) best = entry;
        }
      }
      blocks_[l](bx, by) = best;
    }
  }
  const Rectangle above = block_range(touched);
  for (int ry = above.y0; ry < above.y1; ++ry) {
    for (int rx = above.x0; rx < above.x1; ++rx) {
      const Rectangle extent = extent_of(rx, ry, blocks_[l].bounds());
      Maximum best;
      for (int by = extent.y0; by < extent.y1; ++by) {
        for (int bx = extent.x0; bx < extent.x1; ++bx) {
          if (larger(blocks_[l](bx, by), best)) best = blocks_[l](bx, by);
        }
      }
      regions_[l](rx, ry) = best;
    }
  }
}

RegionEntry RegionQueue::best() const {
  RegionEntry result;
  for (std::size_t l = 0; l < regions_.size(); ++l) {
    Maximum best;
    for (const Maximum& region : regions_[l].pixels()) {
      if (larger(region, best)) best = region;
    }
    if (best.priority > result.priority) {  // levels ascend: a tie keeps the lower one
      result = {static_cast<int>(l) + 1, static_cast<int>(best.index % width_),
                static_cast<int>(best.index / width_), best.priority};
    }
  }
  return result;
}

}  // namespace spool
