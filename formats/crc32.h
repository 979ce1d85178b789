// The checksum of .spool files: CRC-32 as in zlib, PNG and zip.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace spool::format {

// `before` is the checksum of what stands in front of `bytes`.
uint32_t crc32(std::span<const std::byte> bytes, uint32_t before = 0);

}  // namespace spool::format
