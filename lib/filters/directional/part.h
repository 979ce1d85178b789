// A rectangle of the selection that is analysed and filtered alone, and what becomes of it.
#pragma once

#include <optional>
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

struct Part {
  int x0 = 0, y0 = 0;  // of its first piece in the image
  PieceEstimates pieces;
  AnalysisEstimates analysis;
  Plane minimum, maximum;                  // exposed extremes of the samples
  std::vector<SizeChannel> channels;       // what eq 9 looks at instead, where not `analysis`
  std::span<const Plane> attenuation;      // A_0 .. A_K or empty
  std::vector<Plane> cropped_attenuation;  // what it shows, where it is not the selection's
};

struct FilteredPart {
  FilteredPieces pieces;
  CountImage level;
  Plane dominant;
  GuardCounts guards;
};

Part crop(const Part& whole, const Rectangle& box);

// Copies `part` to where `box` lies in `image`, both of the same type.
template <class T>
void paste(const Image<T>& part, const Rectangle& box, Image<T>& image) {
  for (int y = 0; y < part.height(); ++y) {
    for (int x = 0; x < part.width(); ++x)
      image(box.x0 + x, box.y0 + y) = part(x, y);
  }
}

// Tiles of `side` pieces in row-major order; a last row or column narrower than `least` is merged
// into the one before it.
std::vector<Rectangle> cut_tiles(const Rectangle& bounds, int side, int least);

// Joins the views of the tiles, in order of first appearance; NaN where a tile has none.
void join_views(const std::vector<Views>& of_tiles, const std::vector<Rectangle>& tiles,
                const Rectangle& bounds, Views& views);

}  // namespace spool
