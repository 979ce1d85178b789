// How the samples of a recording are held: in memory and in the mapped file, or, where that is more
// than the process may take, read from the file block by block as they are asked for.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "formats/spool_reader.h"
#include "lib/core/working_memory.h"
#include "lib/pool/file_blocks.h"

namespace spool {

struct Holding {
  FileAccess access = FileAccess::kMap;
  std::uint64_t cache_bytes_a_channel = 0;  // of blocks that are kept, where they are read

  bool keep() const { return access == FileAccess::kMap; }
};

// Error: kData when reference, `work` and a few blocks of the layers are more than
// available_memory() already.
Result<Holding> choose_holding(const format::SpoolReader& file,
                               const std::vector<format::LayerInfo>& layers,
                               const WorkingMemory& work);

LayerBlocks held_layer(const std::shared_ptr<const format::SpoolReader>& file,
                       const format::LayerInfo& layer, const Holding& holding);

}  // namespace spool
