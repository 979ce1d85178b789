// Strict opening of a complete .spool file: formats/spool.md 7, steps 1-10.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/dump_geometry.h"
#include "formats/dump_header.h"
#include "formats/file_handle.h"
#include "formats/structures.h"
#include "formats/violation.h"

namespace spool::format {

inline constexpr uint32_t kNoRecord = UINT32_MAX;

struct OpenDump {
  FileHandle file;
  uint64_t file_bytes = 0;
  FileHeader file_header;
  DumpHeader header;
  DumpGeometry geometry;
  Footer footer;
  std::vector<IndexEntry> entries;       // all records but INDX, in file order
  std::vector<uint32_t> record_of_slot;  // entry number, or kNoRecord
  std::vector<std::string> meta;
  uint32_t missing_blocks = 0;
};

Result<OpenDump> open_dump(const std::filesystem::path& path);

// The stored payload of a record, its CRC verified; pad bytes too if `with_pad`.
Result<std::vector<std::byte>> read_payload(const FileHandle& file, const IndexEntry& entry,
                                            bool with_pad = false);

// The same into memory of the caller: as many bytes as the payload has, or with its pad.
Result<void> read_payload_into(const FileHandle& file, const IndexEntry& entry,
                               std::span<std::byte> bytes);

// The decoded payload of a DATA record of a valid geometry.
Judged<std::vector<std::byte>> decode_block(const RecordHeader& record,
                                            const DumpGeometry& geometry,
                                            std::vector<std::byte> stored);

}  // namespace spool::format
