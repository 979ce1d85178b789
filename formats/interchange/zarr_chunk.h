// Buffers that Zarr compresses: Blosc 1, zstd, zlib, or plain.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "lib/core/error.h"

namespace spool::interchange {

enum class ChunkCompressor { kNone, kBlosc, kZstd, kZlib };

// Decodes `stored` into all of `out`, whose size is known from the array's shape; kDamage when it
// gives another number of bytes. `name` opens the message.
Result<void> decode_chunk(ChunkCompressor compressor, std::span<const std::byte> stored,
                          std::span<std::byte> out, std::string_view name);

}  // namespace spool::interchange
