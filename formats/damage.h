// What is damaged in a file, and which samples that concerns.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace spool::format {

// Samples of one tile and group: one block.
struct BlockKey {
  uint16_t group = 0;
  uint32_t tile = 0;
  uint32_t sample_begin = 0;
  uint32_t sample_count = 0;

  bool operator==(const BlockKey&) const = default;
};

struct DamagedRecord {
  std::string type;               // "DATA", "INDX", "footer", ...; "?" for bytes of no known record
  std::optional<BlockKey> block;  // of DATA records whose header is intact
  uint64_t offset = 0;            // in the file
  std::string reason;
  std::optional<uint64_t> sequence = std::nullopt;  // of records whose header is intact
};

}  // namespace spool::format
