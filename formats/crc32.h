// The checksum of .spool files: CRC-32 as in zlib, PNG and zip.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace spool::format {

uint32_t crc32(std::span<const std::byte> bytes);

}  // namespace spool::format
