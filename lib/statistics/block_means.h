// The means of the samples of one block alone, where no variance is asked for. The same
// bits as piece_statistics.h takes one by one: every pixel gets the same operations in the same
// order.
#pragma once

#include "lib/core/image.h"
#include "lib/pool/layer_blocks.h"

namespace spool {

// Adds what `values` [pixel][sample] hold of one channel, the first own[p] of `samples` of each
// pixel, to the means of the `before` samples taken of each: of as many in every pixel as it has.
void add_means(const float* values, int samples, const std::int32_t* own, int pixels, int before,
               double* mean);

// Adds to the rows [row_begin, row_end) of the block's tile what the block holds of the first
// counts(x, y) samples of every pixel; what earlier blocks hold of them has been added.
void add_block_means(const BlockView& block, const CountImage& counts, int row_begin, int row_end,
                     RgbImage& mean);

}  // namespace spool
