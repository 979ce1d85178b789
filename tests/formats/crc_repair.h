// Repairs the checksums of a mutated .spool file, so that a lie reaches the rules behind them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "formats/byte_io.h"
#include "formats/checked_math.h"
#include "formats/crc32.h"
#include "formats/record_layout.h"

namespace spool::format {

// Where the record headers of an intact file stand, INDX included.
inline std::vector<size_t> record_offsets(std::span<const std::byte> file) {
  std::vector<size_t> offsets;
  size_t at = kUnit;
  while (fits(at, 2 * kUnit, file.size())) {
    offsets.push_back(at);
    const auto stored = load<uint64_t>(file, at + record_header::kStoredBytes);
    const auto payload = checked_pad64(stored);
    if (!payload || !fits(at + kUnit, *payload, file.size())) break;
    at += kUnit + static_cast<size_t>(*payload);
  }
  return offsets;
}

inline void seal_unit(std::span<std::byte> file, size_t at) {
  const auto unit = file.subspan(at, kUnit);
  store(unit, kUnit - 4, crc32(unit.first(kUnit - 4)));
}

// The payload CRC of the record at `at`, over its stored bytes as far as the file has them.
inline void seal_payload(std::span<std::byte> file, size_t at) {
  const auto stored = load<uint64_t>(file, at + record_header::kStoredBytes);
  if (!fits(at + kUnit, stored, file.size())) return;
  store(file, at + record_header::kPayloadCrc32,
        crc32(file.subspan(at + kUnit, static_cast<size_t>(stored))));
}

// Copies the record headers into the entries of the index at `index`.
inline void copy_headers_to_index(std::span<std::byte> file, std::span<const size_t> offsets,
                                  size_t index) {
  for (size_t i = 0; i + 1 < offsets.size(); ++i) {
    const size_t entry = index + kUnit + i * kUnit;
    if (!fits(entry, kUnit, file.size())) return;
    std::memcpy(file.data() + entry + index_entry::kType,
                file.data() + offsets[i] + record_header::kType, kUnit - index_entry::kType);
  }
}

// Makes all checksums right. `offsets`: as record_offsets() gave before the mutation.
// keep_index: leave the index entries as they are (a lie may sit there).
inline void seal_all(std::span<std::byte> file, const std::vector<size_t>& offsets,
                     bool keep_index = false) {
  if (file.size() < 2 * kUnit) return;
  seal_unit(file, 0);
  for (size_t i = 0; i < offsets.size(); ++i) {
    const bool is_index = i + 1 == offsets.size();
    if (is_index && !keep_index) copy_headers_to_index(file, offsets, offsets[i]);
    seal_payload(file, offsets[i]);
    seal_unit(file, offsets[i]);
  }
  seal_unit(file, file.size() - kUnit);
}

}  // namespace spool::format
