#include "lib/pyramid/patch.h"

#include <algorithm>
#include <vector>

#include "lib/core/check.h"
#include "lib/core/vector_clones.h"
#include "lib/pyramid/row_sums.h"

namespace spool {
namespace {

// out[x] = (a[x] + a[x + right]) + (b[x] + b[x + right])
template <class T>
SPOOL_VECTOR_CLONES void sum_of_four(const T* a, const T* b, std::ptrdiff_t right, int width,
                                     T* __restrict out) {
  for (int x = 0; x < width; ++x)
    out[x] = (a[x] + a[x + right]) + (b[x] + b[x + right]);
}

template <class From, class To>
SPOOL_VECTOR_CLONES void convert_row(const From* from, int width, To* __restrict to) {
  for (int x = 0; x < width; ++x)
    to[x] = static_cast<To>(from[x]);
}

}  // namespace

void extend_patch(Patch<float>& patch, const Rectangle& bounds, Extension rule) {
  const Rectangle all = patch.extent(), inside = intersect(all, bounds);
  if (inside == all) return;
  for (int y = inside.y0; y < inside.y1; ++y) {
    for (int x = all.x0; x < inside.x0; ++x)
      *patch.at(x, y) = *patch.at(extend(x, bounds.width(), rule), y);
    for (int x = inside.x1; x < all.x1; ++x)
      *patch.at(x, y) = *patch.at(extend(x, bounds.width(), rule), y);
  }
  for (int y = all.y0; y < all.y1; ++y) {
    if (y == inside.y0) y = inside.y1;
    if (y >= all.y1) break;
    std::copy_n(patch.at(all.x0, extend(y, bounds.height(), rule)), all.width(),
                patch.at(all.x0, y));
  }
}

Patch<float> extended_patch(const Image<float>& image, Extension rule, const Rectangle& extent) {
  Patch<float> patch(extent);
  const Rectangle inside = intersect(extent, image.bounds());
  for (int y = inside.y0; y < inside.y1; ++y)
    std::copy_n(&image(inside.x0, y), inside.width(), patch.at(inside.x0, y));
  extend_patch(patch, image.bounds(), rule);
  return patch;
}

template <class From, class To>
Patch<To> padded_patch(const Image<From>& image, const Rectangle& inside, const Rectangle& extent) {
  Patch<To> patch(extent);
  const Rectangle box = intersect(extent, inside);
  for (int y = extent.y0; y < extent.y1; ++y) {
    To* row = patch.at(extent.x0, y);
    if (box.empty() || y < box.y0 || y >= box.y1) {
      std::fill_n(row, extent.width(), To{});
      continue;
    }
    std::fill(row, patch.at(box.x0, y), To{});
    convert_row(&image(box.x0, y), box.width(), patch.at(box.x0, y));
    std::fill(patch.at(box.x0, y) + box.width(), row + extent.width(), To{});
  }
  return patch;
}

void convolve_patch(const Patch<float>& in, const Taps& taps, int dilation, const Rectangle& box,
                    Patch<float>& out) {
  if (box.empty()) return;
  const std::vector<float> weights(taps.values.begin(), taps.values.end());
  const int first = taps.first * dilation, last = taps.last() * dilation;
  SPOOL_CHECK(
      intersect({box.x0 - last, box.y0 - last, box.x1 - first, box.y1 - first}, in.extent()) ==
      Rectangle({box.x0 - last, box.y0 - last, box.x1 - first, box.y1 - first}));
  Patch<float> rows({box.x0, box.y0 - last, box.x1, box.y1 - first});
  weighted_sums(in.at(box.x0 - first, rows.extent().y0), in.stride(), -dilation, weights.data(),
                weights.size(), rows.extent().height(), box.width(),
                rows.at(box.x0, rows.extent().y0), rows.stride());
  weighted_sums(rows.at(box.x0, box.y0 - first), rows.stride(), -dilation * rows.stride(),
                weights.data(), weights.size(), box.height(), box.width(), out.at(box.x0, box.y0),
                out.stride());
}

template <class T>
Patch<T> double_up(const Patch<T>& sums, int level) {
  // R_1 = [x - 1, x]; from then on R_k at x is R_(k-1) at x - 2^(k-2) and at x + 2^(k-2).
  const int step = region_step(level), before = step, after = level == 1 ? 0 : step;
  Patch<T> doubled(grown(sums.extent(), -step));
  const Rectangle box = doubled.extent();
  for (int y = box.y0; y < box.y1; ++y) {
    sum_of_four(sums.at(box.x0 - before, y - before), sums.at(box.x0 - before, y + after),
                before + after, box.width(), doubled.at(box.x0, y));
  }
  return doubled;
}

template Patch<float> double_up(const Patch<float>&, int);
template Patch<std::int32_t> double_up(const Patch<std::int32_t>&, int);
template Patch<float> padded_patch(const Image<float>&, const Rectangle&, const Rectangle&);
template Patch<std::int32_t> padded_patch(const Image<std::int32_t>&, const Rectangle&,
                                          const Rectangle&);
template Patch<std::int32_t> padded_patch(const Image<std::uint8_t>&, const Rectangle&,
                                          const Rectangle&);

}  // namespace spool
