// Finds every intact record of a file, whatever its state: no index, no footer, holes, foreign
// bytes.
//
// A record counts as intact when sync word, header CRC, recording id, the rules that need no
// geometry, payload CRC and pad bytes agree. Past damage the scan goes on in steps of 64 bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/dump_header.h"
#include "formats/file_handle.h"
#include "formats/structures.h"

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

struct RecordScan {
  FileHeader file_header;  // rebuilt from the records if the file's own is damaged
  uint64_t file_bytes = 0;
  std::vector<IndexEntry> intact;  // in file order
  std::vector<DamagedRecord> damaged;
  uint64_t whole_until = kUnit;  // records touch and are intact from the front up to here
  bool header_intact = true;
  bool footer_intact = false;
};

// Errors: kIo; kData when the file is not a .spool file or of a later version; kDamage when not
// even the identity of the recording can be found.
Result<RecordScan> scan_records(const FileHandle& file);

// Geometry and channels of the first intact IMAG and CHAN; the error says what is lost.
Result<DumpHeader> header_of_scan(const FileHandle& file, const RecordScan& scan);

}  // namespace spool::format
