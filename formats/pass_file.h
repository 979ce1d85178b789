// One file of a folder of recorded passes, plain or packed: is it whole, and its values.
//
// Plain: float32 [channel][y][x]. Packed: the same in pieces of kPieceRows rows of one channel,
// each shuffled and compressed by itself or, where that saves nothing, as it is; before them their
// sizes in bytes, u32 [channel][piece].
#pragma once

#include <cstdint>
#include <span>

#include "formats/pass_manifest.h"
#include "lib/core/error.h"

namespace spool::format {

inline constexpr uint32_t kPieceRows = 64;

// Size and CRC-32 of a file of `channels` planes; kDamage where they do not match.
Result<void> verify_pass_file(const PassManifest& manifest, const PassEntry& entry,
                              uint32_t channels);

// Rows [y0, y1) of plane `channel` of `channels` into `values`, float32 [y][x]. Memory: one piece.
Result<void> read_pass_rows(const PassManifest& manifest, const PassEntry& entry, uint32_t channels,
                            uint32_t channel, uint32_t y0, uint32_t y1, std::span<float> values);

}  // namespace spool::format
