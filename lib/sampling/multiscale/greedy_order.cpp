#include "lib/sampling/multiscale/greedy_order.h"

#include <algorithm>
#include <functional>
#include <limits>

#include "lib/core/vector_clones.h"
#include "lib/sampling/multiscale/region_sampling.h"

namespace spool {

namespace {

// Independent maxima, joined at the end: the largest value is the same in any order.
SPOOL_VECTOR_CLONES
double largest_of(const double* row, int width, double largest) {
  double lanes[8];
  std::fill_n(lanes, 8, largest);
  int x = 0;
  for (; x + 8 <= width; x += 8) {
    for (int i = 0; i < 8; ++i)
      lanes[i] = row[x + i] > lanes[i] ? row[x + i] : lanes[i];
  }
  for (; x < width; ++x)
    lanes[0] = row[x] > lanes[0] ? row[x] : lanes[0];
  return *std::max_element(lanes, lanes + 8);
}

}  // namespace

PriorityMaxima::PriorityMaxima(const BlockGrid& grid, const Board& board)
    : grid_(grid), maxima_(board.priority.size() * grid.size()) {
  for (std::size_t l = 0; l < board.priority.size(); ++l) {
    for (std::size_t b = 0; b < grid_.size(); ++b)
      refresh(board, static_cast<int>(l) + 1, b);
  }
}

void PriorityMaxima::refresh(const Board& board, int level, std::size_t b) {
  const auto l = static_cast<std::size_t>(level) - 1;
  const Plane& plane = board.priority[l];
  const Rectangle block = grid_[b];
  double largest = -std::numeric_limits<double>::infinity();
  for (int y = block.y0; y < block.y1; ++y) {
    largest = largest_of(&plane(block.x0, y), block.width(), largest);
  }
  maxima_[l * grid_.size() + b] = largest;
}

GreedyOrder::GreedyOrder(const Board& board, const PriorityMaxima& maxima, double above,
                         std::size_t expected)
    : board_(board),
      maxima_(maxima),
      above_(above),
      expected_(std::max<std::size_t>(expected, 16)),
      upper_(std::numeric_limits<double>::infinity()),
      taken_(board.window.width(), board.window.height()) {
  constexpr std::size_t kSampled = 1 << 12;
  for (const Plane& plane : board.priority)
    entries_ += plane.size();
  const std::size_t stride = (entries_ / kSampled) | 1;
  for (const Plane& plane : board.priority) {
    for (std::size_t i = 0; i < plane.size(); i += stride) {
      if (plane[i] > above_) sampled_.push_back(plane[i]);
    }
  }
  std::sort(sampled_.begin(), sampled_.end(), std::greater<>());
}

bool GreedyOrder::is_free(const RegionEntry& entry) const {
  const Rectangle r = sampled_region(board_, entry);
  for (int y = r.y0; y < r.y1; ++y) {
    for (int x = r.x0; x < r.x1; ++x) {
      if (taken_(x, y)) return false;
    }
  }
  return true;
}

void GreedyOrder::take(const RegionEntry& entry) {
  const Rectangle r = sampled_region(board_, entry);
  for (int y = r.y0; y < r.y1; ++y) {
    for (int x = r.x0; x < r.x1; ++x)
      taken_(x, y) = 1;
  }
}

bool GreedyOrder::gather() {
  batch_.clear();
  batch_used_ = 0;
  while (batch_.empty() && upper_ > above_) {
    const std::size_t per_sample = std::max<std::size_t>(entries_ / (sampled_.size() + 1), 1);
    sampled_used_ += std::max<std::size_t>(4 * expected_ / per_sample, 4);
    const double lower = sampled_used_ < sampled_.size() ? sampled_[sampled_used_] : above_;
    if (lower >= upper_) continue;  // many equal priorities
    for (std::size_t l = 0; l < board_.priority.size(); ++l) {
      const Plane& plane = board_.priority[l];
      for (std::size_t b = 0; b < maxima_.grid().size(); ++b) {
        if (!(maxima_(l, b) > lower)) continue;
        const Rectangle block = intersect(maxima_.grid()[b], board_.area);
        for (int y = block.y0; y < block.y1; ++y) {
          for (int x = block.x0; x < block.x1; ++x) {
            const double priority = plane(x, y);
            if (!(priority > lower && priority <= upper_)) continue;
            const RegionEntry entry{static_cast<int>(l) + 1, x, y, priority};
            if (is_free(entry)) batch_.push_back(entry);
          }
        }
      }
    }
    upper_ = lower;
  }
  std::sort(batch_.begin(), batch_.end(),
            [](const RegionEntry& a, const RegionEntry& b) { return precedes(a, b); });
  return !batch_.empty();
}

RegionEntry GreedyOrder::next() {
  while (true) {
    while (batch_used_ < batch_.size()) {
      const RegionEntry& entry = batch_[batch_used_++];
      if (is_free(entry)) return entry;
    }
    if (!gather()) return {};
  }
}

}  // namespace spool
