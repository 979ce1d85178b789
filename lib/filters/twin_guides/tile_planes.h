// A stack of float images around a tile, in one piece of memory, for loops over whole vectors.
//
// The planes' rows y lie one after the other, so that loops over planes and offsets stay in the
// first cache. They begin at the rectangle's left edge and are rounded up to whole vectors, with
// one vector to spare, so a loop may run over its row's end and over the next row's beginning.
// Floats that were not written hold anything.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <type_traits>

#include "lib/core/image.h"
#include "lib/core/rectangle.h"
#include "lib/filters/twin_guides/lattice.h"

namespace spool {

inline constexpr int kVector = 16;  // floats

inline int whole_vectors(int width) {
  return (width + kVector - 1) / kVector * kVector;
}

// to[x] = from[step x]. Loops over a step that the compiler knows are vector code.
inline void copy_every(int step, const float* from, int x0, int x1, float* __restrict to) {
  const auto copy = [&](auto known) {
    for (int x = x0; x < x1; ++x)
      to[x] = from[known * x];
  };
  if (step == 1) return copy(std::integral_constant<int, 1>());
  if (step == 2) return copy(std::integral_constant<int, 2>());
  if (step == 4) return copy(std::integral_constant<int, 4>());
  copy(step);
}

class TilePlanes {
 public:
  TilePlanes(const Rectangle& covered, std::size_t planes)
      : covered_(covered),
        plane_(static_cast<std::size_t>(whole_vectors(covered.width()) + kVector)),
        stride_(planes * plane_),
        vectors_(stride_ / kVector * static_cast<std::size_t>(covered.height()) + 1),
        values_(std::make_unique_for_overwrite<Vector[]>(vectors_)) {}

  void clear() { std::fill_n(values_[0].lanes, vectors_ * kVector, 0.0f); }
  const Rectangle& covered() const { return covered_; }
  std::ptrdiff_t stride() const {  // from a row to the next
    return static_cast<std::ptrdiff_t>(stride_);
  }
  // Of the place (x, y), which the rectangle holds.
  float* at(std::size_t plane, int x, int y) { return values_[0].lanes + place(plane, x, y); }
  const float* at(std::size_t plane, int x, int y) const {
    return values_[0].lanes + place(plane, x, y);
  }

  // A plane from the pieces of an image on a lattice; the rectangle, in pieces of the lattice, may
  // reach beyond it, where the nearest value inside stands.
  void copy_clamped(std::size_t plane, const Image<float>& image, const Lattice& lattice) {
    for (int y = covered_.y0; y < covered_.y1; ++y) {
      const float* from = image.row(lattice.row(std::clamp(y, 0, lattice.height - 1))).data();
      float* to = at(plane, covered_.x0, y) - covered_.x0;
      const int inside0 = std::clamp(0, covered_.x0, covered_.x1);
      const int inside1 = std::clamp(lattice.width, inside0, covered_.x1);
      std::fill(to + covered_.x0, to + inside0, from[lattice.left]);
      copy_every(lattice.step, from + lattice.left, inside0, inside1, to);
      std::fill(to + inside1, to + covered_.x1, from[lattice.column(lattice.width - 1)]);
    }
  }
  // Every piece of the image.
  void copy_clamped(std::size_t plane, const Image<float>& image) {
    copy_clamped(plane, image, {1, 0, 0, image.width(), image.height()});
  }

 private:
  struct alignas(kVector * sizeof(float)) Vector {
    float lanes[kVector];
  };

  std::size_t place(std::size_t plane, int x, int y) const {
    return plane * plane_ + static_cast<std::size_t>(y - covered_.y0) * stride_ +
           static_cast<std::size_t>(x - covered_.x0);
  }

  Rectangle covered_;
  std::size_t plane_, stride_;  // floats from a plane, a row, to the next
  std::size_t vectors_;
  std::unique_ptr<Vector[]> values_;
};

}  // namespace spool
