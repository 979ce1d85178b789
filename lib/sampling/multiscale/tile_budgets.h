// The budget of each tile: in proportion to the sum of its priorities [LiuZheng (13)].
#pragma once

#include <vector>

#include "lib/sampling/multiscale/board.h"

namespace spool {

// Divides `left` samples exactly, as far as the tiles have room for them; no negative shares.
// `image`: the analysed board of the whole grid. With budget_base = total, what is divided includes
// the samples that the tiles already have; a tile that has more than its share gets nothing.
template <class T>
std::vector<long long> tile_budgets(const std::vector<Rectangle>& tiles,
                                    const AnalysedBoard<T>& image, const Samples& samples,
                                    const SamplePool& pool, long long left,
                                    const MultiscaleOptions& options);

}  // namespace spool
