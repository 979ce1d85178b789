// One LZ4 frame [Lz4Frame] of known size.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "lib/core/error.h"

namespace spool::interchange {

// LZ4 cannot say more than this many bytes with one: what claims more lies, before memory is taken.
inline constexpr size_t kMaxLz4Expansion = 255;

// Decodes exactly one frame that is all of `stored` into all of `out`; kDamage otherwise. `name`
// opens the message: "FILE: tile frame 3".
Result<void> decode_lz4_frame(std::span<const std::byte> stored, std::span<std::byte> out,
                              std::string_view name);

}  // namespace spool::interchange
