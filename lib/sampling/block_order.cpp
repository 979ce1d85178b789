#include "lib/sampling/block_order.h"

#include <algorithm>
#include <functional>
#include <utility>

namespace spool {

BlockOrder::BlockOrder(std::vector<Plane> priorities, std::size_t expected)
    : priorities_(std::move(priorities)), expected_(expected) {
  constexpr std::size_t kSampled = 1 << 12;
  for (const Plane& plane : priorities_)
    blocks_ += plane.size();
  const std::size_t stride = (blocks_ / kSampled) | 1;
  for (const Plane& plane : priorities_) {
    for (std::size_t i = 0; i < plane.size(); i += stride) {
      if (plane[i] > 0.0) sampled_.push_back(plane[i]);
    }
  }
  std::sort(sampled_.begin(), sampled_.end(), std::greater<>());
}

RegionEntry BlockOrder::next() {
  while (used_ == batch_.size()) {
    if (upper_ <= 0.0) return {-1, 0, 0, 0.0};
    gather();
  }
  return batch_[used_++];
}

void BlockOrder::gather() {
  const std::size_t per_sample = blocks_ / (sampled_.size() + 1) + 1;
  sampled_used_ += 2 * expected_ / per_sample + 4;
  const double lower = sampled_used_ < sampled_.size() ? sampled_[sampled_used_] : 0.0;
  batch_.clear();
  used_ = 0;
  for (std::size_t k = 0; k < priorities_.size(); ++k) {
    const Plane& plane = priorities_[k];
    for (int y = 0; y < plane.height(); ++y) {
      for (int x = 0; x < plane.width(); ++x) {
        const double priority = plane(x, y);
        if (priority > lower && priority <= upper_)
          batch_.push_back({static_cast<int>(k), x, y, priority});
      }
    }
  }
  std::sort(batch_.begin(), batch_.end(), precedes);
  upper_ = lower;
}

}  // namespace spool
