// The three 64-byte structures of a .spool file as values, to and from bytes.
//
// Nothing is judged here: header_rules.h says what is allowed. encode() computes the CRC.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "formats/record_layout.h"

namespace spool::format {

using UnitBytes = std::array<std::byte, kUnit>;

struct FileHeader {
  uint16_t major = kMajorVersion;
  uint16_t minor = kMinorVersion;
  uint32_t required_features = 0;
  std::array<uint8_t, 16> dump_uuid{};

  uint64_t dump_id() const;
};

struct RecordHeader {
  std::array<char, 4> type{};
  uint64_t sequence = 0;
  uint64_t dump_id = 0;
  uint64_t stored_bytes = 0;
  uint64_t raw_bytes = 0;
  uint32_t payload_crc32 = 0;
  uint8_t codec = 0;   // a value of Codec in a valid record
  uint8_t filter = 0;  // a value of Filter in a valid record
  uint16_t group = 0;
  uint32_t tile = 0;
  uint32_t sample_begin = 0;
  uint32_t sample_count = 0;

  std::string_view type_name() const { return {type.data(), type.size()}; }
  bool is(std::string_view name) const { return type_name() == name; }
  bool operator==(const RecordHeader&) const = default;
};

struct IndexEntry {
  uint64_t offset = 0;
  RecordHeader header;
};

struct Footer {
  uint64_t index_offset = 0;
  uint64_t file_bytes = 0;
  uint64_t record_count = 0;
  uint64_t dump_id = 0;
  uint64_t data_record_count = 0;
  uint32_t flags = 0;
};

UnitBytes encode(const FileHeader& header);
UnitBytes encode(const RecordHeader& header);
UnitBytes encode(const IndexEntry& entry);
UnitBytes encode(const Footer& footer);

// `bytes` must hold 64 bytes.
FileHeader decode_file_header(std::span<const std::byte> bytes);
RecordHeader decode_record_header(std::span<const std::byte> bytes);
IndexEntry decode_index_entry(std::span<const std::byte> bytes);
Footer decode_footer(std::span<const std::byte> bytes);

std::array<char, 4> record_type(std::string_view name);

}  // namespace spool::format
