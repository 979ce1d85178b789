// A dense two-dimensional array, row-major, x right, y down, origin top-left.
//
// Analysis images are Plane (double); RGB is planar (RgbImage): channel c of pixel (x, y) is
// rgb[c](x, y). Copies are deep; there is no shared state. Distinct pixels may be written by
// distinct threads.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "lib/core/check.h"
#include "lib/core/rectangle.h"

namespace spool {

template <class T>
class Image {
 public:
  using value_type = T;

  Image() = default;
  Image(int width, int height, T fill = T{})
      : width_(width), height_(height), data_(pixels_of(width, height), fill) {}

  int width() const { return width_; }
  int height() const { return height_; }
  std::size_t size() const { return data_.size(); }
  bool empty() const { return data_.empty(); }
  Rectangle bounds() const { return {0, 0, width_, height_}; }

  T& operator()(int x, int y) { return data_[index(x, y)]; }
  const T& operator()(int x, int y) const { return data_[index(x, y)]; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }

  std::span<T> row(int y) { return {data_.data() + index(0, y), static_cast<std::size_t>(width_)}; }
  std::span<const T> row(int y) const {
    return {data_.data() + index(0, y), static_cast<std::size_t>(width_)};
  }
  std::span<T> pixels() { return data_; }
  std::span<const T> pixels() const { return data_; }

  bool same_size(const auto& other) const {
    return width_ == other.width() && height_ == other.height();
  }
  friend bool operator==(const Image&, const Image&) = default;

 private:
  static std::size_t pixels_of(int width, int height) {
    SPOOL_CHECK_GE(width, 0);
    SPOOL_CHECK_GE(height, 0);
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }

  int width_ = 0;
  int height_ = 0;
  std::vector<T> data_;
};

using Plane = Image<double>;
using CountImage = Image<std::int32_t>;
using RgbImage = std::array<Plane, 3>;

inline RgbImage make_rgb(int width, int height, double fill = 0.0) {
  return {Plane(width, height, fill), Plane(width, height, fill), Plane(width, height, fill)};
}

// The part of `image` that lies in `box`; empty where either is.
template <class T>
Image<T> cropped(const Image<T>& image, const Rectangle& box) {
  if (image.empty()) return {};
  Image<T> part(std::max(box.width(), 0), std::max(box.height(), 0));
  if (part.empty()) return part;
  for (int y = 0; y < part.height(); ++y)
    std::copy_n(&image(box.x0, box.y0 + y), part.width(), part.row(y).data());
  return part;
}

// Copies `part` to where `box` lies in `image`.
template <class T>
void paste(const Image<T>& part, const Rectangle& box, Image<T>& image) {
  if (part.empty()) return;
  for (int y = 0; y < part.height(); ++y)
    std::copy_n(part.row(y).data(), part.width(), &image(box.x0, box.y0 + y));
}

// Luminance weights of linear Rec.709 primaries.
inline constexpr std::array<double, 3> kLuminanceWeights = {0.2126, 0.7152, 0.0722};

inline double luminance(double r, double g, double b) {
  return kLuminanceWeights[0] * r + kLuminanceWeights[1] * g + kLuminanceWeights[2] * b;
}

// Whole numbers of pieces - counts, levels - as numbers to calculate and to draw with.
inline Plane as_plane(const CountImage& counts) {
  Plane plane(counts.width(), counts.height());
  for (std::size_t i = 0; i < counts.size(); ++i)
    plane[i] = counts[i];
  return plane;
}

}  // namespace spool
