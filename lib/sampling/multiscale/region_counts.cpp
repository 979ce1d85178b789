#include "lib/sampling/multiscale/region_counts.h"

#include "lib/core/vector_clones.h"
#include "lib/pyramid/row_loop.h"

namespace spool {
namespace {

// sums[x] = image[x - before] + ... + image[x + after] over a row of `width` values with zeros on
// both sides, by doubling: a window of 2^k is two of 2^(k-1). Whole numbers, so any order is exact.
// padded: at least width + 2^level values; sums: the first `width` are the result.
SPOOL_VECTOR_CLONES
void double_up(std::int32_t* values, int level, int padded) {
  for (int k = 0; k < level; ++k) {
    const int step = 1 << k;
    for (int x = 0; x + step < padded; ++x)
      values[x] += values[x + step];
  }
}

SPOOL_VECTOR_CLONES
void add_row(const std::int32_t* from, int width, std::int32_t* to) {
  for (int x = 0; x < width; ++x)
    to[x] += from[x];
}

// Sums over the regions R_level of the entries of `box`; pieces outside `area` count as 0.
template <class T>
CountImage region_sums(const Image<T>& image, const Rectangle& area, int level,
                       const Rectangle& box) {
  const int before = level == 0 ? 0 : 1 << (level - 1), span = 1 << level;
  const int width = box.width(), padded = width + span;
  const int row_begin = box.y0 - before;
  const int rows = box.height() + span;
  // row_sums(x, y): the window that starts at column box.x0 - before + x, of row row_begin + y.
  CountImage row_sums(padded, rows);
  rows_by_area(0, rows, static_cast<long long>(row_sums.size()), [&](int r) {
    const int y = row_begin + r;
    if (y < area.y0 || y >= area.y1) return;
    std::int32_t* to = row_sums.row(r).data();
    const int first = box.x0 - before;
    const int begin = std::max(first, area.x0), end = std::min(first + padded, area.x1);
    if (begin >= end) return;
    const T* from = image.row(y).data();
    for (int x = begin; x < end; ++x)
      to[x - first] = from[x];
    double_up(to, level, padded);
  });
  CountImage sums(width, box.height());
  constexpr int kBand = 64;  // columns that are doubled up together
  const int bands = (width + kBand - 1) / kBand;
  rows_by_area(0, bands, static_cast<long long>(row_sums.size()), [&](int band) {
    const int x0 = band * kBand, x1 = std::min(width, x0 + kBand);
    for (int k = 0; k < level; ++k) {
      for (int r = 0; r + (1 << k) < rows; ++r) {
        std::int32_t* to = row_sums.row(r).data();
        const std::int32_t* from = row_sums.row(r + (1 << k)).data();
        add_row(from + x0, x1 - x0, to + x0);
      }
    }
    for (int y = 0; y < box.height(); ++y)
      std::copy(&row_sums(x0, y), &row_sums(x0, y) + (x1 - x0), &sums(x0, y));
  });
  return sums;
}

// Whether a piece of the area in `pieces` was saturated before this step.
bool any_closed(const Board& board, const Rectangle& pieces) {
  if (board.closed_pieces == 0 || pieces.empty()) return false;
  for (int y = pieces.y0; y < pieces.y1; ++y) {
    const auto row = board.closed.row(y).subspan(static_cast<std::size_t>(pieces.x0),
                                                 static_cast<std::size_t>(pieces.width()));
    if (std::find(row.begin(), row.end(), std::uint8_t{1}) != row.end()) return true;
  }
  return false;
}

}  // namespace

int RegionCounts::largest_fresh() const {
  std::int32_t largest = 0;
  for (const std::int32_t fresh : fresh_.pixels())
    largest = std::max(largest, fresh);
  return largest;
}

RegionCounts::RegionCounts(const Board& board, int level, const Rectangle& box, bool with_fresh)
    : box_(box), area_(board.area) {
  if (level > 0) {
    before_ = 1 << (level - 1);
    after_ = before_ - 1;
  }
  if (with_fresh) fresh_ = region_sums(board.fresh, area_, level, box);
  const Rectangle pieces = grow(box, before_, after_, before_, after_, area_);
  if (any_closed(board, pieces)) closed_ = region_sums(board.closed, area_, level, box);
}

}  // namespace spool
