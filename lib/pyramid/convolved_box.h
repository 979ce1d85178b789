// A convolution on a rectangle of its output: the horizontal pass is made when one is constructed,
// the vertical one is given row by row. Internal to lib/pyramid/convolution.cpp.
//
// Away from the borders both passes run over many rows at once (lib/pyramid/row_sums.h): a box of
// the multiscale sampler is 64 columns wide, for which calling a row costs as much as summing it.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "lib/core/extend.h"
#include "lib/core/image.h"
#include "lib/core/rectangle.h"
#include "lib/pyramid/row_loop.h"
#include "lib/pyramid/row_sums.h"
#include "lib/pyramid/wavelet_filters.h"

namespace spool {

enum class Masking { kNone, kPhase00 };

inline constexpr int kBandRows = 8;  // rows that are worked on together

// The rows of the input that a box of the output reads, each with its place in a compact store.
class NeededRows {
 public:
  NeededRows(const Rectangle& box, const Taps& taps, int dilation, int height,
             Extension extension) {
    const int begin = box.y0 - taps.last() * dilation;
    const int end = box.y1 - taps.first * dilation;
    const bool inside = begin >= 0 && end <= height;
    first_ = inside ? begin : 0;
    slot_.assign(static_cast<std::size_t>(inside ? end - begin : height), -1);
    for (int n = taps.first; n <= taps.last(); ++n) {
      for (int y = box.y0; y < box.y1; ++y)
        slot_[static_cast<std::size_t>(extend(y - n * dilation, height, extension) - first_)] = 0;
    }
    for (std::size_t i = 0; i < slot_.size(); ++i) {
      if (slot_[i] < 0) continue;
      slot_[i] = size();
      rows_.push_back(first_ + static_cast<int>(i));
    }
  }
  int size() const { return static_cast<int>(rows_.size()); }
  int row(int place) const { return rows_[static_cast<std::size_t>(place)]; }
  int place(int y) const { return slot_[static_cast<std::size_t>(y - first_)]; }
  // Without gaps: the place of row y is y - row(0).
  bool contiguous() const { return rows_.back() - rows_.front() + 1 == size(); }

 private:
  int first_ = 0;
  std::vector<int> slot_, rows_;  // slot_[y - first_]: place of row y, or -1
};

template <class T>
class ConvolvedBox {
 public:
  ConvolvedBox(const Image<T>& in, const Taps& taps, int dilation, Extension extension,
               const Rectangle& box, Masking masking)
      : in_(in),
        box_(box),
        needed_(box, taps, dilation, in.height(), extension),
        weights_(taps.values.begin(), taps.values.end()),
        first_(taps.first),
        last_(taps.last()),
        dilation_(dilation),
        extension_(extension),
        store_(std::make_unique_for_overwrite<T[]>(static_cast<std::size_t>(needed_.size()) *
                                                   static_cast<std::size_t>(box.width()))) {
    const int bands = (needed_.size() + kBandRows - 1) / kBandRows;
    rows_by_area(0, bands, static_cast<long long>(needed_.size()) * width(), [&](int band) {
      const int begin = band * kBandRows, end = std::min(begin + kBandRows, needed_.size());
      if (masking == Masking::kNone && needed_.contiguous()) {
        convolve_rows(in_.row(needed_.row(begin)).data(), end - begin, store_row(begin));
        return;
      }
      for (int place = begin; place < end; ++place) {
        const int y = needed_.row(place);
        if (masking == Masking::kNone) {
          convolve_rows(in_.row(y).data(), 1, store_row(place));
        } else {
          const std::vector<T> masked = phase00_of_row(y);
          convolve_rows(masked.data(), 1, store_row(place));
        }
      }
    });
  }

  // Rows y0 .. y1-1 of the box, `stride` apart; several threads may ask.
  void write_rows(int y0, int y1, T* out, std::ptrdiff_t stride) const {
    const int inside_begin = std::clamp(last_ * dilation_, y0, y1);
    const int inside_end = std::clamp(in_.height() + first_ * dilation_, inside_begin, y1);
    if (!needed_.contiguous() || inside_end == inside_begin) {
      for (int y = y0; y < y1; ++y)
        write_row(y, out + (y - y0) * stride);
      return;
    }
    for (int y = y0; y < inside_begin; ++y)
      write_row(y, out + (y - y0) * stride);
    weighted_sums(store_row(needed_.place(inside_begin - first_ * dilation_)), width(),
                  -static_cast<std::ptrdiff_t>(dilation_) * width(), weights_.data(),
                  weights_.size(), inside_end - inside_begin, width(),
                  out + (inside_begin - y0) * stride, stride);
    for (int y = inside_end; y < y1; ++y)
      write_row(y, out + (y - y0) * stride);
  }

 private:
  int width() const { return box_.width(); }
  T* store_row(int place) const {
    return store_.get() + static_cast<std::size_t>(place) * static_cast<std::size_t>(width());
  }

  std::vector<T> phase00_of_row(int y) const {
    std::vector<T> masked(static_cast<std::size_t>(in_.width()), T{});
    if (y / dilation_ % 2 != 0) return masked;
    for (int x = 0; x < in_.width(); ++x) {
      if (x / dilation_ % 2 == 0) masked[static_cast<std::size_t>(x)] = in_(x, y);
    }
    return masked;
  }

  // The horizontal pass of successive rows of the input, columns of the box.
  void convolve_rows(const T* from, int rows, T* out) const {
    const int columns = in_.width();
    const int inside_begin = std::clamp(last_ * dilation_, box_.x0, box_.x1);
    const int inside_end = std::clamp(columns + first_ * dilation_, inside_begin, box_.x1);
    const auto border = [&](int begin, int end) {  // as inside, of a row with its mirrored ends
      if (begin == end) return;
      const int left = begin - last_ * dilation_, right = end - first_ * dilation_;
      std::vector<T> wide(static_cast<std::size_t>(right - left));
      for (int r = 0; r < rows; ++r) {
        const T* row = from + static_cast<std::ptrdiff_t>(r) * columns;
        for (int x = left; x < right; ++x)
          wide[static_cast<std::size_t>(x - left)] = row[extend(x, columns, extension_)];
        weighted_sums(wide.data() + (last_ - first_) * dilation_, 0, -dilation_, weights_.data(),
                      weights_.size(), 1, end - begin,
                      out + static_cast<std::ptrdiff_t>(r) * width() + begin - box_.x0, 0);
      }
    };
    border(box_.x0, inside_begin);
    if (inside_begin < inside_end) {
      weighted_sums(from + (inside_begin - first_ * dilation_), columns, -dilation_,
                    weights_.data(), weights_.size(), rows, inside_end - inside_begin,
                    out + (inside_begin - box_.x0), width());
    }
    border(inside_end, box_.x1);
  }

  // One row whose sources are mirrored or far apart.
  void write_row(int y, T* out) const {
    std::vector<const T*> sources;
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      const int from = y - (first_ + static_cast<int>(i)) * dilation_;
      sources.push_back(store_row(needed_.place(extend(from, in_.height(), extension_))));
    }
    weighted_sum_of_rows(sources.data(), weights_.data(), weights_.size(), width(), out);
  }

  const Image<T>& in_;
  const Rectangle box_;
  NeededRows needed_;
  std::vector<T> weights_;
  int first_, last_, dilation_;
  Extension extension_;
  std::unique_ptr<T[]> store_;
};

}  // namespace spool
