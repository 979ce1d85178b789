// How much larger than its source an import may become without the user's word.
//
// A kilobyte of a compressed file can claim gigabytes of zeros, in memory and on the disk. What an
// importer is going to write is therefore known, and compared with the length of the source,
// before anything is unpacked.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "lib/core/error.h"

namespace spool::interchange {

// Taken from a source of any length.
inline constexpr uint64_t kFreeBytes = uint64_t{32} << 20;
inline constexpr uint64_t kMaxExpansionTimes = 1'000'000;

struct Expansion {
  uint64_t times = 100;  // recordings that compress this well are not known; 1 .. 10^6

  // The most that a source of so many bytes may become: kFreeBytes, or `times` its length.
  uint64_t allowed(uint64_t source_bytes) const;
  // kData when `bytes` are more; an empty number is one beyond 64 bits.
  Result<void> check(const std::string& source, std::optional<uint64_t> bytes,
                     uint64_t source_bytes) const;
};

}  // namespace spool::interchange
