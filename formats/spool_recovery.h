// Saves every intact record of a cut or damaged .spool file into a new complete one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "formats/dump_check.h"
#include "lib/core/error.h"

namespace spool::format {

struct RecoveryReport {
  uint64_t kept_blocks = 0;
  uint64_t kept_records = 0;           // all kinds, the new INDX not counted
  uint64_t lost_records = 0;           // gaps in the sequence numbers, and records seen but damaged
  std::vector<BlockKey> lost;          // blocks that are known to have been there
  std::vector<BlockKey> absent;        // blocks of the geometry of which nothing was found
  std::vector<DamagedRecord> damaged;  // what was found wrong, in file order

  // Absent blocks may never have been recorded; only an index says so. Without one they are gone.
  bool has_index = false;

  bool anything_lost() const { return lost_records != 0 || (!has_index && !absent.empty()); }
};

// Writes `output` with the uuid of the input and new sequence numbers, payloads byte for byte. The
// result is checked as a whole before it gets its name. `force` replaces an existing output; the
// input is never touched.
//
// Errors: as check_dump; kDamage when geometry or channels are lost; kUsage when output is input.
Result<RecoveryReport> recover_dump(const std::filesystem::path& input,
                                    const std::filesystem::path& output, bool force = false);

}  // namespace spool::format
