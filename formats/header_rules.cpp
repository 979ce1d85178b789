#include "formats/header_rules.h"

#include <algorithm>
#include <bit>

#include "formats/byte_io.h"
#include "formats/checked_math.h"
#include "formats/crc32.h"

namespace spool::format {

namespace {

using enum FailureClass;

bool crc_matches(std::span<const std::byte> unit) {
  return crc32(unit.first(kUnit - 4)) == load<uint32_t>(unit, kUnit - 4);
}

// Reserved bytes may carry a meaning only in minor versions that this code does not know.
bool reserved_violated(std::span<const std::byte> reserved, uint16_t minor) {
  return minor <= kMinorVersion && !all_zero(reserved);
}

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool line_ends_translated(std::span<const std::byte> first) {
  constexpr std::array<uint8_t, 5> kUnixEnd = {0x89, 0x53, 0x50, 0x4C, 0x0A};
  constexpr std::array<uint8_t, 7> kDoubledEnd = {0x89, 0x53, 0x50, 0x4C, 0x0D, 0x0D, 0x0A};
  const auto begins = [&](std::span<const uint8_t> pattern) {
    return first.size() >= pattern.size() &&
           std::equal(pattern.begin(), pattern.end(), first.begin(),
                      [](uint8_t a, std::byte b) { return std::byte{a} == b; });
  };
  return begins(kUnixEnd) || begins(kDoubledEnd);
}

Judged<FileHeader> judge_wrong_magic(std::span<const std::byte> first) {
  if (line_ends_translated(first)) {
    return violates(kDamaged, "line ends were translated, as by a text-mode transfer (offset 4)");
  }
  UnitBytes repaired{};
  std::copy_n(first.begin(), kUnit, repaired.begin());
  store(std::span(repaired), file_header::kMagic, kMagicBytes);
  if (crc_matches(repaired)) return violates(kDamaged, "magic is damaged (offset 0)");
  return violates(kNotSpool, "not a .spool file (offset 0: no .spool magic)");
}

}  // namespace

bool is_ancillary(const RecordHeader& record) {
  return record.type[0] >= 'a' && record.type[0] <= 'z';
}

bool is_zero_pad(std::span<const std::byte> pad) {
  return all_zero(pad);
}

std::string_view layer_of(std::string_view channel_name) {
  return channel_name.substr(0, channel_name.find('.'));
}

std::string describe(const RecordHeader& record, uint64_t offset) {
  std::string type(record.type_name());
  for (char& c : type) {
    if (!is_letter(c)) c = '?';
  }
  if (!record.is(kTypeData)) {
    return fmt::format("record {} {}, offset {}", record.sequence, type, offset);
  }
  return fmt::format("record {} {} group {} tile {} samples {}-{}, offset {}", record.sequence,
                     type, record.group, record.tile, record.sample_begin,
                     uint64_t{record.sample_begin} + record.sample_count - 1, offset);
}

Judged<FileHeader> check_file_header(std::span<const std::byte> first) {
  const auto magic = std::as_bytes(std::span(kMagicBytes));
  const size_t compared = std::min(first.size(), magic.size());
  const bool magic_ok = std::ranges::equal(first.first(compared), magic.first(compared));
  if (first.size() < kUnit) {
    if (magic_ok)
      return violates(kIncomplete, "cut within the file header ({} bytes)", first.size());
    return violates(kNotSpool, "not a .spool file ({} bytes, no .spool magic)", first.size());
  }
  if (!magic_ok) return judge_wrong_magic(first);
  if (!crc_matches(first.first(kUnit)))
    return violates(kDamaged, "file header is damaged (offset 0)");
  const FileHeader header = decode_file_header(first);
  if (header.major != kMajorVersion) {
    return violates(kUnsupported, "format version {}.{} (this program reads {}.x)", header.major,
                    header.minor, kMajorVersion);
  }
  if (const uint32_t unknown = header.required_features & ~kKnownFeatures; unknown != 0) {
    return violates(kUnsupported, "needs feature bit {} (offset {})", std::countr_zero(unknown),
                    file_header::kRequiredFeatures);
  }
  const auto reserved =
      first.subspan(file_header::kReserved, file_header::kCrc32 - file_header::kReserved);
  if (reserved_violated(reserved, header.minor)) {
    return violates(kInvalid, "reserved bytes of the file header are not 0 (offset {})",
                    file_header::kReserved);
  }
  return header;
}

Judged<Footer> check_footer(std::span<const std::byte> last, const FileHeader& header,
                            uint64_t file_bytes) {
  const uint64_t at = file_bytes - kUnit;
  if (load<std::array<uint8_t, 8>>(last, footer::kEndMagic) != kEndMagicBytes) {
    return violates(kIncomplete, "no footer: cut or never finished (offset {})", at);
  }
  if (!crc_matches(last)) return violates(kDamaged, "footer is damaged (offset {})", at);
  const Footer footer = decode_footer(last);
  if (footer.dump_id != header.dump_id()) {
    return violates(kDamaged, "footer belongs to another recording (offset {})", at);
  }
  if (footer.file_bytes != file_bytes) {
    return violates(kDamaged, "footer says {} bytes, the file has {} (offset {})",
                    footer.file_bytes, file_bytes, at);
  }
  if (footer.record_count < kMinRecords || footer.record_count > kMaxRecords) {
    return violates(kDamaged, "record count {} outside {}..{} (offset {})", footer.record_count,
                    kMinRecords, kMaxRecords, at);
  }
  const auto index_bytes = checked_product({kUnit, footer.record_count - 1});
  const auto end = checked_sum({footer.index_offset, kUnit, *index_bytes, kUnit});
  if (footer.index_offset % kUnit != 0 || end != file_bytes) {
    return violates(kDamaged, "index offset {} does not fit {} records in {} bytes (offset {})",
                    footer.index_offset, footer.record_count, file_bytes, at);
  }
  const auto reserved = last.subspan(footer::kReserved, footer::kEndMagic - footer::kReserved);
  if (reserved_violated(reserved, header.minor)) {
    return violates(kDamaged, "reserved bytes of the footer are not 0 (offset {})",
                    at + footer::kReserved);
  }
  if (header.minor <= kMinorVersion && (footer.flags & ~kFlagComplete) != 0) {
    return violates(kDamaged, "unknown footer flags {:#x} (offset {})", footer.flags, at);
  }
  return footer;
}

Judged<RecordHeader> check_record_bytes(std::span<const std::byte> bytes) {
  if (load<std::array<uint8_t, 4>>(bytes, record_header::kSync) != kSyncBytes) {
    return violates(kDamaged, "no record header");
  }
  if (!crc_matches(bytes)) return violates(kDamaged, "record header is damaged");
  return decode_record_header(bytes);
}

Judged<void> check_record_alone(const RecordHeader& record, uint64_t dump_id) {
  if (record.dump_id != dump_id) return violates(kDamaged, "record belongs to another recording");
  if (!std::ranges::all_of(record.type, is_letter)) {
    return violates(kDamaged, "record type is not four letters");
  }
  const bool is_data = record.is(kTypeData);
  const bool is_known =
      is_data || record.is(kTypeImag) || record.is(kTypeChan) || record.is(kTypeIndx);
  if (!is_known && !is_ancillary(record)) {
    return violates(kUnsupported, "unknown critical record type {}", record.type_name());
  }
  if (record.codec > static_cast<uint8_t>(Codec::kZstd)) {
    return violates(kUnsupported, "unknown codec {}", record.codec);
  }
  if (record.filter > static_cast<uint8_t>(Filter::kByteShuffle)) {
    return violates(kUnsupported, "unknown filter {}", record.filter);
  }
  if (record.sequence >= kMaxRecords) {
    return violates(kDamaged, "sequence number {} above the limit of records", record.sequence);
  }
  const bool coded = record.codec != 0;
  if (coded && !is_data) return violates(kDamaged, "{} has a codec", record.type_name());
  if (record.filter != 0 && !coded) return violates(kDamaged, "filter without codec");
  if (record.raw_bytes > kMaxRawBytes) {
    return violates(kDamaged, "raw_bytes {} above the limit {}", record.raw_bytes, kMaxRawBytes);
  }
  const bool stored_ok =
      coded ? record.stored_bytes < record.raw_bytes : record.stored_bytes == record.raw_bytes;
  if (record.stored_bytes == 0 || !stored_ok) {
    return violates(kDamaged, "stored_bytes {} against raw_bytes {}", record.stored_bytes,
                    record.raw_bytes);
  }
  if (!is_data && (record.group != 0 || record.tile != 0 || record.sample_begin != 0 ||
                   record.sample_count != 0)) {
    return violates(kDamaged, "{} has a group, tile or sample range", record.type_name());
  }
  return {};
}

Judged<uint32_t> check_data_record(const RecordHeader& record, const DumpGeometry& geometry) {
  if (record.group >= geometry.groups().size()) {
    return violates(kDamaged, "group {} of {}", record.group, geometry.groups().size());
  }
  const GroupLayout& group = geometry.groups()[record.group];
  if (record.tile >= group.tiles) {
    return violates(kDamaged, "tile {} of {}", record.tile, group.tiles);
  }
  const auto block = geometry.block_of(record.group, record.sample_begin);
  if (!block) return violates(kDamaged, "no block begins at sample {}", record.sample_begin);
  if (record.sample_count != geometry.block_count(record.group, *block)) {
    return violates(kDamaged, "block has {} samples, expected {}", record.sample_count,
                    geometry.block_count(record.group, *block));
  }
  const uint64_t expected = geometry.raw_bytes(record.group, record.tile, *block);
  if (record.raw_bytes != expected) {
    return violates(kDamaged, "raw_bytes {}, the geometry gives {}", record.raw_bytes, expected);
  }
  return *block;
}

Judged<void> check_preamble_sizes(const RecordHeader& imag, const RecordHeader& chan) {
  if (imag.raw_bytes != kUnit) return violates(kDamaged, "IMAG has {} bytes", imag.raw_bytes);
  if (chan.raw_bytes % kUnit != 0 || chan.raw_bytes > kUnit * kMaxChannels) {
    return violates(kDamaged, "CHAN has {} bytes", chan.raw_bytes);
  }
  return {};
}

}  // namespace spool::format
