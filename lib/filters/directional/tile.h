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
#include "lib/filters/directional/options.h"
#include "lib/kernels/piece_estimates.h"
#include "lib/pool/sample_pool.h"
#include "lib/statistics/piece_statistics.h"
#include "lib/statistics/selection.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {

// What the size rule looks at where not the selection's own signal decides: its samples again, by
// luminance, by the largest channel, or by red, green and blue each alone. The exposure, the limit
// and the map of the selection's signal hold for all of them.
struct SizeChannel {
  Plane mean, variance;    // [y][x] exposed; variance of `mean`
  Plane minimum, maximum;  // [y][x] exposed extremes of the samples; +-infinity where n = 0
};

// Red, green and blue, with `exposure` in place of the signal's own.
std::vector<SizeChannel> size_channels(const PieceStatistics& statistics, const SamplePool& pool,
                                       double exposure, const VarianceOptions& variance);

// `statistics` with the signal that the option names; per_channel keeps it, as of_selection does.
PieceStatistics with_analysis_channel(PieceStatistics statistics, const SamplePool& pool,
                                      SizeChannels channels);

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
