// SHA-256 [Fips180], the identity of a file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "formats/file_handle.h"
#include "lib/core/error.h"

namespace spool::interchange {

class Sha256 {
 public:
  void add(std::span<const std::byte> bytes);
  std::string hex();  // 64 digits; the object is spent afterwards

 private:
  void add_block(const std::byte* block);

  std::array<uint32_t, 8> state_ = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                    0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::byte, 64> block_{};
  size_t filled_ = 0;
  uint64_t total_bytes_ = 0;
};

// Of a whole file, read from front to back.
Result<std::string> sha256_of(const format::FileHandle& file);

}  // namespace spool::interchange
