// Means of the samples in the cells of the subpixel grid (pixel_base.h), a row of pixels at a time.
#pragma once

#include <array>

#include "lib/core/image.h"
#include "lib/pool/sample_pool.h"
#include "lib/statistics/piece_statistics.h"

namespace spool {

inline constexpr int kCellsPerPixel = 4;  // per side, of the subpixel grid

// Means of the cells of pixels x0 .. x1 - 1 of row y, to[c] [kCellsPerPixel][kCellsPerPixel (x1 -
// x0)]; an empty cell takes its pixel's mean, as do all without film positions.
void cell_means_of_row(const PieceStatistics& statistics, const SamplePool& pool,
                       const RgbImage& pixel_mean, int y, int x0, int x1,
                       const std::array<double*, 3>& to);

}  // namespace spool
