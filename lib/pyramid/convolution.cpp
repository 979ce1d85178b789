#include "lib/pyramid/convolution.h"

#include <algorithm>
#include <vector>

#include "lib/core/vector_clones.h"
#include "lib/pyramid/convolved_box.h"
#include "lib/pyramid/row_loop.h"

namespace spool {
namespace {

template <class T>
SPOOL_VECTOR_CLONES void subtract_from(const T* minuend, int width, T* __restrict row) {
  for (int x = 0; x < width; ++x)
    row[x] = minuend[x] - row[x];
}

void check_box(bool same_size, const Rectangle& box, const Rectangle& bounds, const Taps& taps,
               int dilation) {
  SPOOL_CHECK(same_size);
  SPOOL_CHECK(intersect(box, bounds) == box);
  SPOOL_CHECK_GE(dilation, 1);
  SPOOL_CHECK(!taps.values.empty());
}

// finish(y, row): row points at out(box.x0, y), which holds the convolved values.
template <class T, class Finish>
void convolve_and_finish(const Image<T>& in, const Taps& taps, int dilation, Extension extension,
                         const Rectangle& box, Masking masking, Image<T>& out, Finish&& finish) {
  check_box(in.same_size(out), box, in.bounds(), taps, dilation);
  SPOOL_CHECK(&in != &out);
  if (box.empty()) return;
  const ConvolvedBox<T> convolved(in, taps, dilation, extension, box, masking);
  const int bands = (box.height() + kBandRows - 1) / kBandRows;
  rows_by_area(0, bands, box.area(), [&](int band) {
    const int y0 = box.y0 + band * kBandRows, y1 = std::min(y0 + kBandRows, box.y1);
    convolved.write_rows(y0, y1, &out(box.x0, y0), out.width());
    for (int y = y0; y < y1; ++y)
      finish(y, &out(box.x0, y));
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
