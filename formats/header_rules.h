// The rules of formats/spool.md about headers and records; geometry_rules.h has those about the
// image.
//
// The functions judge bytes or values and touch no file. Reader, writer, check and recovery all
// call them; there is no second copy of a rule.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "formats/dump_geometry.h"
#include "formats/dump_header.h"
#include "formats/structures.h"
#include "formats/violation.h"

namespace spool::format {

// Steps 1-3. `first` is the beginning of the file: 64 bytes, or fewer if the file is shorter.
Judged<FileHeader> check_file_header(std::span<const std::byte> first);

// Steps 4-5. `last` is the last 64 bytes of a file of `file_bytes` >= 128 bytes.
Judged<Footer> check_footer(std::span<const std::byte> last, const FileHeader& header,
                            uint64_t file_bytes);

// Sync word and CRC of 64 bytes; nothing else.
Judged<RecordHeader> check_record_bytes(std::span<const std::byte> bytes);

// The rules of one record header that need no geometry (step 7), its sequence number apart.
Judged<void> check_record_alone(const RecordHeader& record, uint64_t dump_id);

// A DATA header against the geometry (step 9). Returns the block number in its group.
Judged<uint32_t> check_data_record(const RecordHeader& record, const DumpGeometry& geometry);

// Payload sizes of IMAG and CHAN that may be read at all (step 8).
Judged<void> check_preamble_sizes(const RecordHeader& imag, const RecordHeader& chan);

bool is_ancillary(const RecordHeader& record);
bool is_zero_pad(std::span<const std::byte> pad);

// "radiance" of "radiance.R".
std::string_view layer_of(std::string_view channel_name);

// "record 5 DATA group 0 tile 3 samples 16-31, offset 4480"
std::string describe(const RecordHeader& record, uint64_t offset);

}  // namespace spool::format
