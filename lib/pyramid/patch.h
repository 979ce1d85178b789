// A rectangle of an image in memory of its own, which may reach beyond the image's borders.
//
// What several stages make of a small part of a picture stays in a core's cache this way. Each
// value depends on its inputs alone and terms are added in their order, so no result depends on
// where a patch begins or ends. Slow twins: tests/reference/convolution_reference.h,
// region_mean_reference.h.
#pragma once

#include <cstddef>
#include <memory>

#include "lib/core/extend.h"
#include "lib/core/image.h"
#include "lib/core/rectangle.h"
#include "lib/pyramid/wavelet_filters.h"

namespace spool {

template <class T>
class Patch {
 public:
  // The values are not set.
  explicit Patch(const Rectangle& extent)
      : extent_(extent),
        values_(std::make_unique_for_overwrite<T[]>(static_cast<std::size_t>(extent.area()))) {}

  const Rectangle& extent() const { return extent_; }
  std::ptrdiff_t stride() const { return extent_.width(); }
  // The value of (x, y), coordinates of the image; the rest of the row follows.
  T* at(int x, int y) { return values_.get() + (y - extent_.y0) * stride() + (x - extent_.x0); }
  const T* at(int x, int y) const {
    return values_.get() + (y - extent_.y0) * stride() + (x - extent_.x0);
  }

 private:
  Rectangle extent_;
  std::unique_ptr<T[]> values_;
};

inline Rectangle grown(const Rectangle& r, int by) {
  return {r.x0 - by, r.y0 - by, r.x1 + by, r.y1 + by};
}

// The values of an image in the patch, and beyond its borders what the rule says.
Patch<float> extended_patch(const Image<float>& image, Extension rule, const Rectangle& extent);
// The same for a patch that has the values inside `bounds`. Where the rule looks must lie in it.
void extend_patch(Patch<float>& patch, const Rectangle& bounds, Extension rule);

// The values inside `inside`, 0 elsewhere.
template <class From, class To>
Patch<To> padded_patch(const Image<From>& image, const Rectangle& inside, const Rectangle& extent);

// out = taps *_dilation in, on `box`; `in` must reach as far around it as the taps do.
void convolve_patch(const Patch<float>& in, const Taps& taps, int dilation, const Rectangle& box,
                    Patch<float>& out);

// Sums over the regions R_level (lib/pyramid/region_mean.h) from those of level - 1, level >= 1:
// four of them, three additions. The result reaches less far by region_step(level).
template <class T>
Patch<T> double_up(const Patch<T>& sums, int level);
inline int region_step(int level) {
  return level == 1 ? 1 : 1 << (level - 2);
}

}  // namespace spool
