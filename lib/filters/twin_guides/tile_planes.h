// A stack of float images around a tile, in one piece of memory, for loops over whole vectors.
//
// Rows begin at the rectangle's left edge and are rounded up to whole vectors, with one vector to
// spare, so a loop may run over its row's end and over the next row's beginning.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "lib/core/image.h"
#include "lib/core/rectangle.h"
#include "lib/filters/twin_guides/lattice.h"

namespace spool {

inline constexpr int kVector = 16;  // floats

inline int whole_vectors(int width) {
  return (width + kVector - 1) / kVector * kVector;
}

class TilePlanes {
 public:
  TilePlanes(const Rectangle& covered, std::size_t planes)
      : covered_(covered),
        stride_(whole_vectors(covered.width()) + kVector),
        plane_(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(covered.height())),
        values_(planes * plane_ + kVector) {}

  const Rectangle& covered() const { return covered_; }
  std::ptrdiff_t stride() const { return stride_; }  // from a row to the next
  // Of the place (x, y), which the rectangle holds.
  float* at(std::size_t plane, int x, int y) { return values_.data() + place(plane, x, y); }
  const float* at(std::size_t plane, int x, int y) const {
    return values_.data() + place(plane, x, y);
  }

  // A plane from the pieces of an image on a lattice; the rectangle, in pieces of the lattice, may
  // reach beyond it, where the nearest value inside stands.
  void copy_clamped(std::size_t plane, const Image<float>& image, const Lattice& lattice) {
    for (int y = covered_.y0; y < covered_.y1; ++y) {
      const float* from = image.row(lattice.row(std::clamp(y, 0, lattice.height - 1))).data();
      float* to = at(plane, covered_.x0, y) - covered_.x0;
      const int inside0 = std::clamp(0, covered_.x0, covered_.x1);
      const int inside1 = std::clamp(lattice.width, inside0, covered_.x1);
      for (int x = covered_.x0; x < inside0; ++x)
        to[x] = from[lattice.left];
      for (int x = inside0; x < inside1; ++x)
        to[x] = from[lattice.column(x)];
      for (int x = inside1; x < covered_.x1; ++x)
        to[x] = from[lattice.column(lattice.width - 1)];
    }
  }
  // Every piece of the image.
  void copy_clamped(std::size_t plane, const Image<float>& image) {
    copy_clamped(plane, image, {1, 0, 0, image.width(), image.height()});
  }

 private:
  std::size_t place(std::size_t plane, int x, int y) const {
    return plane * plane_ +
           static_cast<std::size_t>(y - covered_.y0) * static_cast<std::size_t>(stride_) +
           static_cast<std::size_t>(x - covered_.x0);
  }

  Rectangle covered_;
  int stride_;
  std::size_t plane_;
  std::vector<float> values_;
};

}  // namespace spool
