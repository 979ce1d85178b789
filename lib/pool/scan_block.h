// Counts the samples of a block that the rules look at: not finite, negative, beyond the limit.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/pool/layer_blocks.h"
#include "lib/pool/sanitise.h"

namespace spool {

// Whether every value of a row of one channel is finite, not negative and within the limit, so that
// scan_block() would count none of it; -0 is not taken for plain.
bool is_plain_row(const BlockRow& row, const SanitiseRules& rules);

// Of the three channels of radiance. Everything but the empty pixels, which one block cannot know.
SanitiseReport scan_block(const BlockView& block, const SanitiseRules& rules);

// Pixels that keep no ordinary sample; `blocks` holds what scan_block() said of each.
std::uint64_t count_empty_pixels(const LayerBlocks& radiance,
                                 const std::vector<SanitiseReport>& blocks);

}  // namespace spool
