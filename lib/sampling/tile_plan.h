// Divides the board into tiles that are sampled alone, and the budget among them [LiuZheng (13)].
#pragma once

#include <functional>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/rectangle.h"

namespace spool {

// Tiles of tile_size^2 pieces in y, x order; a last row or column narrower than `smallest` is part
// of its neighbour. tile_size = 0: one tile. Error kUsage unless tile_size is a multiple of
// `smallest` (2^K: a tile holds at least one region of the largest level).
Result<std::vector<Rectangle>> plan_tiles(int width, int height, int tile_size, int smallest);

// run(t) for every tile, the largest budget first; in parallel if asked for.
void for_each_tile(const std::vector<long long>& budgets, bool parallel,
                   const std::function<void(std::size_t)>& run);

}  // namespace spool
