#include "lib/sampling/multiscale/region_counts.h"

#include <algorithm>

#include "lib/pyramid/row_loop.h"

namespace spool {
namespace {

// Sums over [x - before, x + after]^2 clipped to `area`, for the entries of `box`. Whole numbers,
// so the order of additions is free.
template <class T>
CountImage window_sums(const Image<T>& image, const Rectangle& area, int before, int after,
                       const Rectangle& box) {
  const int width = box.width();
  const int row_begin = std::max(box.y0 - before, area.y0);
  const int row_end = std::max(std::min(box.y1 + after, area.y1), row_begin);
  CountImage rows(width, row_end - row_begin);
  const long long work = static_cast<long long>(rows.size());
  rows_by_area(row_begin, row_end, work, [&](int y) {
    const T* from = image.row(y).data();
    std::int32_t* to = rows.row(y - row_begin).data();
    for (int x = box.x0; x < box.x1; ++x) {
      std::int32_t sum = 0;
      for (int i = std::max(x - before, area.x0); i < std::min(x + after + 1, area.x1); ++i)
        sum += from[i];
      to[x - box.x0] = sum;
    }
  });
  CountImage sums(width, box.height());
  rows_by_area(box.y0, box.y1, work, [&](int y) {
    std::int32_t* to = sums.row(y - box.y0).data();
    const int last = std::min(y + after + 1, area.y1);
    for (int j = std::max(y - before, area.y0); j < last; ++j) {
      const std::int32_t* from = rows.row(j - row_begin).data();
      for (int x = 0; x < width; ++x)
        to[x] += from[x];
    }
  });
  return sums;
}

}  // namespace

RegionCounts::RegionCounts(const Board& board, int level, const Rectangle& box)
    : box_(box), area_(board.area) {
  if (level > 0) {
    before_ = 1 << (level - 1);
    after_ = before_ - 1;
  }
  fresh_ = window_sums(board.fresh, area_, before_, after_, box);
  if (board.closed_pieces > 0) closed_ = window_sums(board.closed, area_, before_, after_, box);
}

}  // namespace spool
