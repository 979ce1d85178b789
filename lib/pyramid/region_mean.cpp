#include "lib/pyramid/region_mean.h"

#include <algorithm>

#include "lib/pyramid/row_loop.h"
#include "lib/pyramid/row_sums.h"

namespace spool {
namespace {

// A region spans [x - before, x + after].
struct Window {
  int before = 0, after = 0;
};

Window window_of(int level) {
  SPOOL_CHECK_GE(level, 0);
  SPOOL_CHECK_LE(level, 8);
  if (level == 0) return {};
  return {1 << (level - 1), (1 << (level - 1)) - 1};
}

// out[r * (x1 - x0) + x - x0] = in[x - before] + ... + in[x + after] in row r of `in`, in that
// order, clipped to the row.
void sum_rows(const double* in, int columns, Window window, int x0, int x1, int rows,
              double* __restrict out) {
  const int inside_begin = std::clamp(window.before, x0, x1);
  const int inside_end = std::clamp(columns - window.after, inside_begin, x1);
  const auto border = [&](int begin, int end) {
    for (int r = 0; r < rows; ++r) {
      const double* row = in + static_cast<std::ptrdiff_t>(r) * columns;
      for (int x = begin; x < end; ++x) {
        const int last = std::min(x + window.after, columns - 1);
        int i = std::max(x - window.before, 0);
        double sum = row[i];
        for (++i; i <= last; ++i)
          sum += row[i];
        out[static_cast<std::ptrdiff_t>(r) * (x1 - x0) + x - x0] = sum;
      }
    }
  };
  border(x0, inside_begin);
  const int n = inside_end - inside_begin;
  if (n > 0) {
    plain_sums(in + inside_begin - window.before, columns, 1, window.before + window.after + 1,
               rows, n, out + (inside_begin - x0), x1 - x0);
  }
  border(inside_end, x1);
}

template <class Finish>
void sum_and_finish(const Plane& image, int level, const Rectangle& box, Plane& out,
                    Finish&& finish) {
  SPOOL_CHECK(image.same_size(out));
  SPOOL_CHECK(&image != &out);
  SPOOL_CHECK(intersect(box, image.bounds()) == box);
  if (box.empty()) return;
  const Window window = window_of(level);
  const int width = box.width();
  const int row_begin = std::max(box.y0 - window.before, 0);
  const int row_end = std::min(box.y1 + window.after, image.height());
  const auto store = std::make_unique_for_overwrite<double[]>(
      static_cast<std::size_t>(row_end - row_begin) * static_cast<std::size_t>(width));
  const auto store_row = [&](int y) {
    return store.get() + static_cast<std::size_t>(y - row_begin) * static_cast<std::size_t>(width);
  };
  constexpr int kBand = 8;  // rows that are worked on together
  const auto bands = [](int rows) { return (rows + kBand - 1) / kBand; };
  rows_by_area(0, bands(row_end - row_begin), static_cast<long long>(row_end - row_begin) * width,
               [&](int band) {
                 const int y0 = row_begin + band * kBand, y1 = std::min(y0 + kBand, row_end);
                 sum_rows(image.row(y0).data(), image.width(), window, box.x0, box.x1, y1 - y0,
                          store_row(y0));
               });
  rows_by_area(0, bands(box.height()), box.area(), [&](int band) {
    const int y0 = box.y0 + band * kBand, y1 = std::min(y0 + kBand, box.y1);
    if (y0 >= window.before && y1 + window.after <= image.height()) {
      plain_sums(store_row(y0 - window.before), width, width, window.before + window.after + 1,
                 y1 - y0, width, &out(box.x0, y0), out.width());
    } else {
      for (int y = y0; y < y1; ++y) {
        const int first = std::max(y - window.before, 0);
        const int last = std::min(y + window.after, image.height() - 1);
        plain_sums(store_row(first), width, width, last - first + 1, 1, width, &out(box.x0, y),
                   out.width());
      }
    }
    for (int y = y0; y < y1; ++y)
      finish(y, &out(box.x0, y));
  });
}

}  // namespace

Rectangle region(int x, int y, int level, const Rectangle& bounds) {
  const Window window = window_of(level);
  return intersect(
      {x - window.before, y - window.before, x + window.after + 1, y + window.after + 1}, bounds);
}

Plane region_sum(const Plane& image, int level) {
  Plane out(image.width(), image.height());
  sum_and_finish(image, level, image.bounds(), out, [](int, double*) {});
  return out;
}

Plane region_mean(const Plane& image, int level) {
  Plane out(image.width(), image.height());
  region_mean_box(image, level, image.bounds(), out);
  return out;
}

void region_mean_box(const Plane& image, int level, const Rectangle& box, Plane& out) {
  const Window window = window_of(level);
  const auto terms = [&](int at, int n) {
    return std::min(at + window.after, n - 1) - std::max(at - window.before, 0) + 1;
  };
  const int whole = window.before + window.after + 1;
  const double inverse = 1.0 / (static_cast<double>(whole) * whole);  // a power of two
  const int inside_begin = std::clamp(window.before, box.x0, box.x1);
  const int inside_end = std::clamp(image.width() - window.after, inside_begin, box.x1);
  sum_and_finish(image, level, box, out, [&](int y, double* row) {
    const int rows = terms(y, image.height());
    const auto divide = [&](int begin, int end) {
      for (int x = begin; x < end; ++x)
        row[x - box.x0] /= static_cast<double>(terms(x, image.width()) * rows);
    };
    if (rows < whole) return divide(box.x0, box.x1);
    divide(box.x0, inside_begin);
    for (int x = inside_begin; x < inside_end; ++x)
      row[x - box.x0] *= inverse;
    divide(inside_end, box.x1);
  });
}

Rectangle region_influence(const Rectangle& changed, int level, const Rectangle& bounds) {
  if (changed.empty()) return {};
  const Window window = window_of(level);
  return grow(changed, window.after, window.before, window.after, window.before, bounds);
}

}  // namespace spool
