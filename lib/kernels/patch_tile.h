// The patch filter (lib/kernels/patch_filter.h) of one tile, with nothing larger than the tile.
#pragma once

#include <vector>

#include "lib/core/image.h"
#include "lib/core/rectangle.h"

namespace spool {

struct PatchFilterOptions {
  int window = 10;  // r, pieces
  int patch = 3;    // f
  double kappa = 0.45;
  double alpha = 1.0;  // share of the noise taken off a distance
};

// One half of the samples as a guide; exposed, or in any unit with the same epsilon.
struct HalfImage {
  RgbImage mean, variance;
};

// Up to four images of one size, filtered alike, and what guides them.
struct GuidedTargets {
  std::vector<const Plane*> targets;
  const HalfImage* guide = nullptr;
};

// The filtered targets [target][y][x] of the tile, from its corner.
std::vector<Plane> filter_tile(const GuidedTargets& guided, const PatchFilterOptions& options,
                               const Rectangle& tile);

}  // namespace spool
