#include "lib/pyramid/region_mean.h"

#include <algorithm>
#include <memory>

#include "lib/pyramid/row_loop.h"

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

// out[x - x0] = in[x - before] + ... + in[x + after], in that order, clipped to the row.
void sum_row(const double* in, int width, Window window, int x0, int x1, double* __restrict out) {
  const int inside_begin = std::clamp(window.before, x0, x1);
  const int inside_end = std::clamp(width - window.after, inside_begin, x1);
  const auto border = [&](int begin, int end) {
    for (int x = begin; x < end; ++x) {
      const int last = std::min(x + window.after, width - 1);
      int i = std::max(x - window.before, 0);
      double sum = in[i];
      for (++i; i <= last; ++i)
        sum += in[i];
      out[x - x0] = sum;
    }
  };
  border(x0, inside_begin);
  const int n = inside_end - inside_begin;
  if (n > 0) {
    const double* from = in + inside_begin - window.before;
    double* to = out + (inside_begin - x0);
    std::copy(from, from + n, to);
    // The window of a level >= 1 has an even number of terms: one, then pairs, then one.
    int term = 1;
    const int terms = window.before + window.after + 1;
    for (; term + 2 <= terms; term += 2) {
      const double *a = from + term, *b = a + 1;
      for (int x = 0; x < n; ++x)
        to[x] = to[x] + a[x] + b[x];
    }
    for (; term < terms; ++term) {
      const double* a = from + term;
      for (int x = 0; x < n; ++x)
        to[x] += a[x];
    }
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
  rows_by_area(row_begin, row_end, static_cast<long long>(row_end - row_begin) * width, [&](int y) {
    sum_row(image.row(y).data(), image.width(), window, box.x0, box.x1, store_row(y));
  });
  rows_by_area(box.y0, box.y1, box.area(), [&](int y) {
    double* __restrict row = &out(box.x0, y);
    int from = std::max(y - window.before, 0);
    const int last = std::min(y + window.after, image.height() - 1);
    std::copy(store_row(from), store_row(from) + width, row);
    for (++from; from + 1 <= last; from += 2) {
      const double *a = store_row(from), *b = store_row(from + 1);
      for (int x = 0; x < width; ++x)
        row[x] = row[x] + a[x] + b[x];
    }
    for (; from <= last; ++from) {
      const double* a = store_row(from);
      for (int x = 0; x < width; ++x)
        row[x] += a[x];
    }
    finish(y, row);
  });
}

}  // namespace

Rectangle region(int x, int y, int level, const Rectangle& bounds) {
  const Window window = window_of(level);
  return intersect(
      {x - window.before, y - window.before, x + window.after + 1, y + window.after + 1}, bounds);
}

int region_count(int x, int y, int level, const Rectangle& bounds) {
  return static_cast<int>(region(x, y, level, bounds).area());
}

Plane region_sum(const Plane& image, int level) {
  Plane out(image.width(), image.height());
  region_sum_box(image, level, image.bounds(), out);
  return out;
}

Plane region_mean(const Plane& image, int level) {
  Plane out(image.width(), image.height());
  region_mean_box(image, level, image.bounds(), out);
  return out;
}

void region_sum_box(const Plane& image, int level, const Rectangle& box, Plane& out) {
  sum_and_finish(image, level, box, out, [](int, double*) {});
}

void region_mean_box(const Plane& image, int level, const Rectangle& box, Plane& out) {
  const Rectangle bounds = image.bounds();
  sum_and_finish(image, level, box, out, [&](int y, double* row) {
    for (int x = box.x0; x < box.x1; ++x) {
      row[x - box.x0] /= static_cast<double>(region_count(x, y, level, bounds));
    }
  });
}

Rectangle region_influence(const Rectangle& changed, int level, const Rectangle& bounds) {
  if (changed.empty()) return {};
  const Window window = window_of(level);
  return grow(changed, window.after, window.before, window.after, window.before, bounds);
}

}  // namespace spool
