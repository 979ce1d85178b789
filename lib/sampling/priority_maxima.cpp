#include "lib/sampling/priority_maxima.h"

#include <algorithm>

#include "lib/core/parallel.h"
#include "lib/core/vector_clones.h"

namespace spool {
namespace {

constexpr int kSide = kMaximaSide;

int blocks_of(int n) {
  return (n + kSide - 1) / kSide;
}

// Independent maxima, joined at the end: the largest value is the same in any order.
template <class T>
SPOOL_VECTOR_CLONES T largest_of(const T* row, int width) {
  T lanes[8];
  std::fill_n(lanes, 8, -std::numeric_limits<T>::infinity());
  int x = 0;
  for (; x + 8 <= width; x += 8) {
    for (int i = 0; i < 8; ++i)
      lanes[i] = row[x + i] > lanes[i] ? row[x + i] : lanes[i];
  }
  for (; x < width; ++x)
    lanes[0] = row[x] > lanes[0] ? row[x] : lanes[0];
  return *std::max_element(lanes, lanes + 8);
}

Rectangle extent_of(int bx, int by, const Rectangle& bounds) {
  return intersect({bx * kSide, by * kSide, (bx + 1) * kSide, (by + 1) * kSide}, bounds);
}

}  // namespace

template <class T>
PriorityMaxima<T>::PriorityMaxima(const std::vector<Image<T>>& images, int first_level)
    : images_(&images), first_level_(first_level) {
  for (const Image<T>& image : images) {
    rows_.emplace_back(blocks_of(image.width()), image.height());
    blocks_.emplace_back(blocks_of(image.width()), blocks_of(image.height()));
  }
  for (std::size_t i = 0; i < images.size(); ++i) {
    const int across = blocks_[i].width();
    parallel_for(blocks_[i].size(), [&](std::size_t b) {
      const int bx = static_cast<int>(b) % across, by = static_cast<int>(b) / across;
      refresh_block(i, bx, by, extent_of(bx, by, images[i].bounds()));
    });
  }
}

template <class T>
void PriorityMaxima<T>::refresh_block(std::size_t image, int bx, int by, const Rectangle& changed) {
  const Image<T>& priority = (*images_)[image];
  const Rectangle block = extent_of(bx, by, priority.bounds());
  Image<T>& rows = rows_[image];
  for (int y = changed.y0; y < changed.y1; ++y)
    rows(bx, y) = largest_of(&priority(block.x0, y), block.width());
  RegionEntry best;  // the first row that has the largest value, and its first entry
  best.level = static_cast<int>(image) + first_level_;
  best.y = block.y0;
  for (int y = block.y0; y < block.y1; ++y) {
    if (rows(bx, y) > best.priority) best.priority = rows(bx, y), best.y = y;
  }
  const T* row = &priority(block.x0, best.y);
  best.x = block.x0 + static_cast<int>(
                          std::find(row, row + block.width(), static_cast<T>(best.priority)) - row);
  blocks_[image](bx, by) = best;
}

template <class T>
void PriorityMaxima<T>::refresh(int level, const Rectangle& changed) {
  if (changed.empty()) return;
  const auto image = static_cast<std::size_t>(level - first_level_);
  SPOOL_CHECK_LT(image, blocks_.size());
  for (int by = changed.y0 / kSide; by < blocks_of(changed.y1); ++by) {
    for (int bx = changed.x0 / kSide; bx < blocks_of(changed.x1); ++bx)
      refresh_block(image, bx, by,
                    intersect(changed, extent_of(bx, by, images_->at(image).bounds())));
  }
}

template <class T>
std::optional<RegionEntry> PriorityMaxima<T>::best() const {
  RegionEntry best;
  bool any = false;
  for (const Image<RegionEntry>& blocks : blocks_) {
    for (const RegionEntry& entry : blocks.pixels()) {
      if (entry.priority < best.priority) continue;
      if (entry.priority == -std::numeric_limits<double>::infinity()) continue;
      if (!any || precedes(entry, best)) best = entry, any = true;
    }
  }
  return any ? std::optional(best) : std::nullopt;
}

template class PriorityMaxima<double>;
template class PriorityMaxima<float>;

}  // namespace spool
