// The blocks of a layer of a .spool file: mapped where they are stored as they are used, decoded
// where not.
#pragma once

#include <cstdint>
#include <memory>

#include "formats/spool_reader.h"
#include "lib/pool/layer_blocks.h"

namespace spool {

enum class FileAccess {
  kMap,   // blocks of plain floats stay in the file, which is mapped
  kRead,  // every block is read into memory, and nothing is mapped
};

LayerGrid layer_grid(const format::DumpHeader& header);

// Errors of the reader: those of format::SpoolReader; kDamage when a block is missing, naming its
// tile and samples.
BlockReader file_blocks(std::shared_ptr<const format::SpoolReader> file,
                        const format::LayerInfo& layer, FileAccess access);

// The same, for the first reading of blocks that are mapped, verified while their rows are looked
// at; the file is read into the processor's cache rather than mapped where a block is not expected
// to be looked at again.
PieceReader file_pieces(std::shared_ptr<const format::SpoolReader> file,
                        const format::LayerInfo& layer);

// What the blocks of a layer take of memory that are not mapped.
std::uint64_t unmapped_bytes(const format::SpoolReader& file, const format::LayerInfo& layer,
                             FileAccess access);

}  // namespace spool
