// Weights of single pixels in the filters of this folder: what lib/core/footprint.h holds.
#pragma once

#include <span>
#include <vector>

#include "lib/core/footprint.h"
#include "lib/core/image.h"
#include "lib/kernels/feature_guide.h"
#include "lib/kernels/patch_tile.h"

namespace spool {

// Of pixel (x, y) in guided_means of `values` [c][y][x] pieces, each piece at its own scale:
// scales[scale(x, y)], 0 for none.
Footprint guided_footprint(const FeatureGuide& guide, const RgbImage& values,
                           const CountImage& scale, std::span<const double> scales,
                           int pieces_per_side, int x, int y);

struct PatchWeight {
  int x = 0, y = 0;  // piece
  double weight = 0.0;
};

// Of piece (x, y) in the patch filter with that guide; they sum to 1. Found by filtering images
// that are 1 at one piece and 0 elsewhere, so they are the filter's own.
std::vector<PatchWeight> patch_weights(const HalfImage& guide, const PatchFilterOptions& options,
                                       int x, int y);

}  // namespace spool
