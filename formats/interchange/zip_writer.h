// A zip of stored members whose sizes are known beforehand; zip64 where 4 GiB are exceeded.
//
// The members' bytes are written at their places in any order; finish_zip reads them back for the
// checksums and adds headers and directory. Source: [Appnote].
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/file_handle.h"
#include "lib/core/error.h"

namespace spool::interchange {

struct PlannedMember {
  std::string name;
  uint64_t bytes = 0;
  uint64_t header_offset = 0;  // set by plan_zip
  uint64_t data_offset = 0;    // set by plan_zip
};

// Lays the members out one after the other; returns where the directory will stand.
uint64_t plan_zip(std::vector<PlannedMember>& members);

// At most 65534 members.
Result<void> finish_zip(format::FileHandle& file, const std::vector<PlannedMember>& members);

}  // namespace spool::interchange
