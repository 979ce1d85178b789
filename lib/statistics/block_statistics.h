// The samples of one block added to the statistics of its pixels, four neighbours side by side in
// registers. The same bits as piece_statistics.h takes one by one: every pixel gets the same
// operations in the same order.
#pragma once

#include "lib/core/image.h"
#include "lib/pool/layer_blocks.h"

namespace spool {

// Planes of piece_statistics.h that are added to, all of the picture's size; those of the colours
// may be null.
struct StatisticsPlanes {
  RgbImage* mean = nullptr;
  RgbImage* m2 = nullptr;
  Plane* signal_mean = nullptr;
  Plane* signal_m2 = nullptr;
  Plane* signal_minimum = nullptr;
  Plane* signal_maximum = nullptr;
};

// Adds to the rows [row_begin, row_end) of the block's tile what the block holds of the first
// counts(x, y) samples of every pixel; what earlier blocks hold of them has been added. The signal
// is exposure times the luminance.
void add_block(const StatisticsPlanes& planes, double exposure, const BlockView& block,
               const CountImage& counts, int row_begin, int row_end);

}  // namespace spool
