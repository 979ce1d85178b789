#include "formats/crc32.h"

#include <zlib.h>

namespace spool::format {

uint32_t crc32(std::span<const std::byte> bytes) {
  return static_cast<uint32_t>(
      ::crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

}  // namespace spool::format
