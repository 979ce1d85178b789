// The common half of every importer: arrays of a foreign file -> one .spool, block by block.
//
// Memory: about one tile of one block of a group, or 64 MiB where a tile's samples are read
// together; never the image. What was done stands twice: in the report, and in `meta.import`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/dump_header.h"
#include "formats/interchange/dump_plan.h"
#include "formats/interchange/expansion.h"
#include "lib/core/error.h"

namespace spool::interchange {

// Options that mean the same for every format.
struct ImportOptions {
  uint32_t tile_size = 64;
  uint32_t block_spp = 0;  // 0: 16, or more where the file would need too many blocks
  bool compress = false;
  bool force = false;                               // replace OUT
  Expansion expansion;                              // how much larger than the source OUT may be
  std::optional<format::SampleOrder> sample_order;  // where the source does not say
  std::optional<std::array<uint8_t, 16>> uuid;      // random when absent
};

struct ImportReport {
  uint32_t width = 0, height = 0, spp = 0;
  std::vector<std::string> layers;
  ValueCounts counts;
  std::vector<std::string> notes;  // one line each, for the user
};

// What the layers take in a .spool, before compression; empty beyond 64 bits.
std::optional<uint64_t> stored_bytes(const std::vector<ForeignLayer>& layers);

// Writes OUT and completes the report. kData when it would be larger than `options.expansion` of
// plan.record.files allows, before anything is written. A layer is a group of its own while 16
// groups suffice; else layers of equal dtype and scope share one.
Result<ImportReport> write_dump(const std::filesystem::path& out, DumpPlan plan,
                                const ImportOptions& options);

}  // namespace spool::interchange
