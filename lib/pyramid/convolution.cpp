#include "lib/pyramid/convolution.h"

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "lib/core/vector_clones.h"
#include "lib/pyramid/row_loop.h"
#include "lib/pyramid/row_sums.h"

namespace spool {
namespace {

// Where the terms of a sum begin; few of them, as usual, need no memory.
template <class T>
class SourceRows {
 public:
  explicit SourceRows(std::size_t count) : many_(count > few_.size() ? count : 0) {}
  const T*& operator[](std::size_t i) { return data()[i]; }
  const T** data() { return many_.empty() ? few_.data() : many_.data(); }

 private:
  std::array<const T*, 16> few_;
  std::vector<const T*> many_;
};

// One row of the horizontal pass: out[x - x0] for x = x0 .. x1-1.
template <class T>
void convolve_row(const T* in, int width, int first, const std::vector<T>& weights, int dilation,
                  Extension extension, int x0, int x1, T* out) {
  const int count = static_cast<int>(weights.size());
  const int last = first + count - 1;
  const int inside_begin = std::clamp(last * dilation, x0, x1);
  const int inside_end = std::clamp(width + first * dilation, inside_begin, x1);
  const auto border = [&](int begin, int end) {
    for (int x = begin; x < end; ++x) {
      T sum = weights[0] * in[extend(x - first * dilation, width, extension)];
      for (int i = 1; i < count; ++i) {
        sum += weights[static_cast<std::size_t>(i)] *
               in[extend(x - (first + i) * dilation, width, extension)];
      }
      out[x - x0] = sum;
    }
  };
  border(x0, inside_begin);
  if (inside_begin < inside_end) {
    SourceRows<T> sources(weights.size());
    for (int i = 0; i < count; ++i) {
      sources[static_cast<std::size_t>(i)] = in + (inside_begin - (first + i) * dilation);
    }
    weighted_sum_of_rows(sources.data(), weights.data(), weights.size(), inside_end - inside_begin,
                         out + (inside_begin - x0));
  }
  border(inside_end, x1);
}

template <class T>
SPOOL_VECTOR_CLONES void subtract_from(const T* minuend, int width, T* __restrict row) {
  for (int x = 0; x < width; ++x)
    row[x] = minuend[x] - row[x];
}

enum class Masking { kNone, kPhase00 };

// finish(y, row): row points at out(box.x0, y), which holds the convolved values.
template <class T, class Finish>
void convolve_and_finish(const Image<T>& in, const Taps& taps, int dilation, Extension extension,
                         const Rectangle& box, Masking masking, Image<T>& out, Finish&& finish) {
  SPOOL_CHECK(in.same_size(out));
  SPOOL_CHECK(&in != &out);
  SPOOL_CHECK(intersect(box, in.bounds()) == box);
  SPOOL_CHECK_GE(dilation, 1);
  SPOOL_CHECK(!taps.values.empty());
  if (box.empty()) return;
  const int width = box.width(), height = in.height();
  const int count = static_cast<int>(taps.values.size());
  const std::vector<T> weights(taps.values.begin(), taps.values.end());

  // Only the rows that the vertical pass reads, in a compact store.
  std::vector<int> slot(static_cast<std::size_t>(height), -1);
  std::vector<int> needed;
  for (int y = box.y0; y < box.y1; ++y) {
    for (int n = taps.first; n <= taps.last(); ++n) {
      int& s = slot[static_cast<std::size_t>(extend(y - n * dilation, height, extension))];
      if (s < 0) s = 0;
    }
  }
  for (int y = 0; y < height; ++y) {
    int& s = slot[static_cast<std::size_t>(y)];
    if (s < 0) continue;
    s = static_cast<int>(needed.size());
    needed.push_back(y);
  }
  const auto store =
      std::make_unique_for_overwrite<T[]>(needed.size() * static_cast<std::size_t>(width));
  const auto store_row = [&](int s) {
    return store.get() + static_cast<std::size_t>(s) * static_cast<std::size_t>(width);
  };

  const int rows = static_cast<int>(needed.size());
  rows_by_area(0, rows, static_cast<long long>(rows) * width, [&](int s) {
    const int y = needed[static_cast<std::size_t>(s)];
    if (masking == Masking::kNone) {
      convolve_row(in.row(y).data(), in.width(), taps.first, weights, dilation, extension, box.x0,
                   box.x1, store_row(s));
      return;
    }
    std::vector<T> masked(static_cast<std::size_t>(in.width()), T{});
    if (y / dilation % 2 == 0) {
      for (int x = 0; x < in.width(); ++x) {
        if (x / dilation % 2 == 0) masked[static_cast<std::size_t>(x)] = in(x, y);
      }
    }
    convolve_row(masked.data(), in.width(), taps.first, weights, dilation, extension, box.x0,
                 box.x1, store_row(s));
  });
  rows_by_area(box.y0, box.y1, box.area(), [&](int y) {
    SourceRows<T> sources(weights.size());
    for (int i = 0; i < count; ++i) {
      const int from = extend(y - (taps.first + i) * dilation, height, extension);
      sources[static_cast<std::size_t>(i)] = store_row(slot[static_cast<std::size_t>(from)]);
    }
    T* row = &out(box.x0, y);
    weighted_sum_of_rows(sources.data(), weights.data(), weights.size(), width, row);
    finish(y, row);
  });
}

template <class T>
void subtract_with(const Image<T>& minuend, const Image<T>& in, const Taps& taps, int dilation,
                   Extension extension, const Rectangle& box, Masking masking, Image<T>& out) {
  SPOOL_CHECK(minuend.same_size(in));
  convolve_and_finish(in, taps, dilation, extension, box, masking, out,
                      [&](int y, T* row) { subtract_from(&minuend(box.x0, y), box.width(), row); });
}

struct Interval {
  int begin = 0, end = 0;  // half open
};

Interval axis_influence(Interval changed, int reach_left, int reach_right, int n,
                        Extension extension) {
  const int begin = changed.begin, end = changed.end;
  // A reach of a whole side can reflect several times: take the whole axis.
  if (std::max(std::max(reach_left, reach_right), 0) >= n) return {0, n};
  std::vector<Interval> copies = {changed};
  switch (extension) {
    case Extension::kSymmetric:
      copies.push_back({-end, -begin});
      copies.push_back({2 * n - end, 2 * n - begin});
      break;
    case Extension::kWhole:
      copies.push_back({1 - end, 1 - begin});
      copies.push_back({2 * n - 1 - end, 2 * n - 1 - begin});
      break;
    case Extension::kPeriodic:
      copies.push_back({begin - n, end - n});
      copies.push_back({begin + n, end + n});
      break;
    case Extension::kClamp:
      if (begin == 0) copies.push_back({-n, 0});
      if (end == n) copies.push_back({n, 2 * n});
      break;
  }
  Interval result{n, 0};
  for (const Interval& copy : copies) {
    const int low = std::max(copy.begin - reach_left, 0);
    const int high = std::min(copy.end + reach_right, n);
    if (low >= high) continue;
    result.begin = std::min(result.begin, low);
    result.end = std::max(result.end, high);
  }
  return result;
}

}  // namespace

template <class T>
void convolve_box(const Image<T>& in, const Taps& taps, int dilation, Extension extension,
                  const Rectangle& box, Image<T>& out) {
  convolve_and_finish(in, taps, dilation, extension, box, Masking::kNone, out, [](int, T*) {});
}

template <class T>
void subtract_convolved_box(const Image<T>& minuend, const Image<T>& in, const Taps& taps,
                            int dilation, Extension extension, const Rectangle& box,
                            Image<T>& out) {
  subtract_with(minuend, in, taps, dilation, extension, box, Masking::kNone, out);
}

template <class T>
void subtract_convolved_phase00_box(const Image<T>& minuend, const Image<T>& in, const Taps& taps,
                                    int dilation, Extension extension, const Rectangle& box,
                                    Image<T>& out) {
  subtract_with(minuend, in, taps, dilation, extension, box, Masking::kPhase00, out);
}

template <class T>
Image<T> convolve(const Image<T>& in, const Taps& taps, int dilation, Extension extension) {
  Image<T> out(in.width(), in.height());
  convolve_box(in, taps, dilation, extension, in.bounds(), out);
  return out;
}

template <class T>
Image<T> gaussian_blur(const Image<T>& in, double sigma, Extension extension) {
  return convolve(in, gaussian_taps(sigma), 1, extension);
}

Rectangle convolution_influence(const Rectangle& changed, const Taps& taps, int dilation,
                                Extension extension, const Rectangle& bounds) {
  if (changed.empty()) return {};
  const int left = -taps.first * dilation, right = taps.last() * dilation;
  const Interval x =
      axis_influence({changed.x0, changed.x1}, left, right, bounds.width(), extension);
  const Interval y =
      axis_influence({changed.y0, changed.y1}, left, right, bounds.height(), extension);
  return {x.begin, y.begin, x.end, y.end};
}

#define SPOOL_INSTANTIATE_CONVOLUTION(T)                                                           \
  template void convolve_box(const Image<T>&, const Taps&, int, Extension, const Rectangle&,       \
                             Image<T>&);                                                           \
  template void subtract_convolved_box(const Image<T>&, const Image<T>&, const Taps&, int,         \
                                       Extension, const Rectangle&, Image<T>&);                    \
  template void subtract_convolved_phase00_box(const Image<T>&, const Image<T>&, const Taps&, int, \
                                               Extension, const Rectangle&, Image<T>&);            \
  template Image<T> convolve(const Image<T>&, const Taps&, int, Extension);                        \
  template Image<T> gaussian_blur(const Image<T>&, double, Extension)
SPOOL_INSTANTIATE_CONVOLUTION(double);
SPOOL_INSTANTIATE_CONVOLUTION(float);
#undef SPOOL_INSTANTIATE_CONVOLUTION

}  // namespace spool
