// Verifies every record of a .spool file, pad bytes included; also of files that do not open.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/record_scan.h"
#include "lib/core/error.h"

namespace spool::format {

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
