// Blocks that were read last, for recordings larger than memory.
#pragma once

#include <cstdint>

#include "lib/pool/layer_blocks.h"

namespace spool {

// Gives what `reader` gives, and keeps the blocks asked for last, up to `bytes` of them together:
// those that are still held elsewhere count as well, and one block is never too many. `channels`
// of `grid` say what a block takes. From any thread.
BlockReader cached_blocks(BlockReader reader, const LayerGrid& grid, int channels,
                          std::uint64_t bytes);

}  // namespace spool
