// The weights of a feature guide (lib/kernels/feature_guide.h) between the rows of one tile and
// those around it, all offsets of a row at once.
#pragma once

#include <cstddef>
#include <vector>

#include "lib/core/image.h"
#include "lib/core/rectangle.h"
#include "lib/kernels/feature_guide.h"

namespace spool {

class GuideTile {
 public:
  static constexpr int kLanes = 8;  // a register of AVX2; wider vectors lie in memory there

  // For offsets up to `across` in x and `down` in y.
  GuideTile(const FeatureGuide& guide, const Rectangle& tile, int across, int down);

  // Weights of the pieces of row y with those of row qy: to[(dx + across) * stride + i] is of the
  // piece x = tile.x0 - across + i and the one at dx from it, 0 where either is beyond the image.
  // Of pieces beside the tile, with `beside`, those whose other piece is in the tile; no others
  // have a meaning. `to` has whole lanes: stride >= lanes of tile.width() + 2 across.
  void weights(int y, int qy, bool beside, std::ptrdiff_t stride, float* to) const;

 private:
  struct Feature {
    std::vector<Image<float>> mean;  // times the root of the factor
    Image<float> variance;
  };

  int guide_width_;
  Rectangle tile_;
  int across_, down_;
  std::vector<Feature> features_;  // rows from tile.y0 - down, columns from tile.x0 - 2 across
};

}  // namespace spool
