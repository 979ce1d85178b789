// Stored bytes of a DATA payload to plain bytes and back: none, or byte shuffle and zstd.
//
// The decoded size always comes from the caller, who computed it from the geometry; the decoder
// gets it as a hard bound and a result of another size is damage.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "formats/record_layout.h"
#include "formats/violation.h"

namespace spool::format {

// shuffled[k * n + i] = plain[i * e + k] for elements of e bytes; sizes are multiples of e.
void shuffle_bytes(std::span<const std::byte> plain, uint32_t element_bytes,
                   std::span<std::byte> shuffled);
void unshuffle_bytes(std::span<const std::byte> shuffled, uint32_t element_bytes,
                     std::span<std::byte> plain);

// Fills `plain`, whose size is the expected one.
Judged<void> decode_payload(Codec codec, Filter filter, std::span<const std::byte> stored,
                            uint32_t element_bytes, std::span<std::byte> plain);

// Shuffled and compressed; nullopt where that saves less than 5 %.
std::optional<std::vector<std::byte>> compress_payload(std::span<const std::byte> plain,
                                                       uint32_t element_bytes);

}  // namespace spool::format
