// Weights between every two pieces of one another's windows, on one tile of a lattice.
//
//   z(p, q) = |p - q|^2 / (2 sigma^2) + feature_gain max(0, max_c ((F_p - F_q)^2 - V) / (V + 0.01))
//             + mean over the guides' channels of max(0, (g_p - g_q)^2 - U) / (U + tau^2)
//   w       = max(0, exp(-z) - exp(-cut)),      V, U: sums of both variances
//
// z is symmetric, so half of the offsets are computed. Taking exp(-cut) off lets a neighbour fade
// out instead of leaving with a jump, which rounding could decide. w is 0 where p or q is outside
// the image. Pieces, windows and |p - q| are those of the lattice. Slow twin:
// tests/reference/twin_guides_reference.h.
#pragma once

#include <vector>

#include "lib/filters/twin_guides/guides.h"
#include "lib/filters/twin_guides/lattice.h"
#include "lib/filters/twin_guides/tile_planes.h"

namespace spool {

struct WindowShape {
  int radius;    // pieces of the lattice
  double sigma;  // of the Gaussian, pieces of the lattice
};

class WindowWeights {
 public:
  WindowWeights(const Lattice& lattice, const Rectangle& tile, const WindowShape& shape,
                const GuidePyramid& pyramid, const FeatureImages& features,
                const TwinGuidesOptions& options);

  // The window, row by row: offsets, and of each the row of weights of the pieces (x .., y) of the
  // tile with those at the offset.
  struct Offset {
    int dx, dy;
  };
  const std::vector<Offset>& offsets() const { return offsets_; }
  int radius() const { return radius_; }
  const float* row(std::size_t offset, int x, int y) const;
  // sum w v and sum w over the windows of `width` pieces from (x, y) on, whole vectors of them.
  void sum(const TilePlanes& values, std::size_t plane, int x, int y, int width, float* sum,
           float* total) const;
  // sum (w (v - mean))^2 of the same.
  void squared_deviations(const TilePlanes& values, std::size_t plane, int x, int y, int width,
                          const float* mean, float* sum) const;

 private:
  void compute(const Rectangle& tile, const TilePlanes& guides, const TilePlanes& features,
               std::size_t channels, const Rectangle& image, double sigma,
               const TwinGuidesOptions& options);

  int radius_;
  std::vector<Offset> offsets_;
  TilePlanes planes_;  // of (0, 0) and the offsets after it, for the tile and what lies before it
};

}  // namespace spool
