// What is analysed and filtered alone: the whole image, or a rectangle of it; and what becomes of
// it.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "lib/core/image.h"
#include "lib/core/rectangle.h"
#include "lib/core/view.h"
#include "lib/filters/directional/anisotropic_filter.h"
#include "lib/filters/directional/size_channels.h"
#include "lib/kernels/piece_estimates.h"
#include "lib/statistics/selection.h"

namespace spool {

struct Tile {
  int x0 = 0, y0 = 0;                      // of its first piece in the image
  PieceEstimates pieces;                   // what is averaged
  AnalysisEstimates analysis;              // what decides, here and below
  CountImage n;                            // samples that decide
  Plane minimum, maximum;                  // exposed extremes of the samples
  std::vector<SizeChannel> channels;       // what eq 9 looks at instead, where not `analysis`
  std::span<const Plane> attenuation;      // A_0 .. A_K or empty
  std::vector<Plane> cropped_attenuation;  // what it shows, where it is not the selection's
};

struct FilteredTile {
  FilteredPieces pieces;
  CountImage level;
  Plane dominant;
  GuardCounts guards;
};

// Tiles of `side` pieces in row-major order; a last row or column narrower than `least` is part of
// the one before it.
std::vector<Rectangle> cut_tiles(const Rectangle& bounds, int side, int least);

// `filter` of every tile, in parallel, joined. Views are joined in order of first appearance, NaN
// where a tile has none.
using TileFilter = std::function<FilteredTile(Tile, Views*)>;
FilteredTile filter_tiles(const Tile& whole, int side, int least, const TileFilter& filter,
                          Views* views);

}  // namespace spool
