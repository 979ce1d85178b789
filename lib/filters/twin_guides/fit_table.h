// The inputs of one tile and its windows, piece after piece, as the loops over windows read them:
// one vector of regressors, colours and differences to a piece.
#pragma once

#include <cstddef>
#include <vector>

#include "lib/filters/twin_guides/lattice.h"
#include "lib/filters/twin_guides/scale_inputs.h"

namespace spool {

inline constexpr int kLanes = 16;            // regressors, three colours, three differences
inline constexpr int kPosition = 3;          // regressors without features: 1, y, x
inline constexpr float kPerPosition = 0.1f;  // 1 / 10 pieces of the lattice
typedef float Lanes __attribute__((vector_size(kLanes * sizeof(float))));
// In one line of the cache: what lies across two takes twice as long.
struct alignas(kLanes * sizeof(float)) Piece {
  float lanes[kLanes];
};

class FitTable {
 public:
  FitTable(const Lattice& lattice, const Rectangle& tile, int radius, const ScaleInputs& inputs);

  int rows() const { return rows_; }  // regressors; the colours follow
  int place(int x, int y) const {     // of a piece of the lattice
    return (y - around_.y0) * around_.width() + (x - around_.x0);
  }
  // Regressor of a row or column of the lattice, for a piece itself or less than one beside it.
  float down(int y, float more = 0.0f) const {
    return kPerPosition * (static_cast<float>(y - origin_y_) + more);
  }
  float right(int x, float more = 0.0f) const {
    return kPerPosition * (static_cast<float>(x - origin_x_) + more);
  }
  int step(int dx, int dy) const { return dy * around_.width() + dx; }
  const float* lanes(int place = 0) const {
    return pieces_.data()->lanes + static_cast<std::ptrdiff_t>(place) * kLanes;
  }
  // Of the colours.
  const float* luminances() const { return luminance_.data(); }

 private:
  Rectangle around_;  // the tile and its windows inside the lattice
  int origin_x_, origin_y_;
  int rows_;
  std::vector<Piece> pieces_;
  std::vector<float> luminance_;
};

}  // namespace spool
