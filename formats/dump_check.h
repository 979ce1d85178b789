// Verifies every record of a .spool file, pad bytes included; also of files that do not open.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lib/core/error.h"

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

struct CheckReport {
  bool complete = false;   // opens strictly, nothing damaged, no block missing
  bool opens = false;      // opens strictly
  std::string open_error;  // the line of SpoolReader::open, if it does not
  uint64_t records = 0;    // records found intact
  uint64_t bytes = 0;      // size of the file
  std::vector<DamagedRecord> damaged;
  std::vector<BlockKey> missing;  // blocks of the geometry of which no intact record exists

  bool intact() const { return opens && damaged.empty(); }
};

// Errors: kIo unreadable; kData not a .spool file, unsupported or invalid. Damage is not an error
// here: it is what the report lists.
Result<CheckReport> check_dump(const std::filesystem::path& path);

}  // namespace spool::format
