#include "formats/structures.h"

#include <algorithm>

#include "formats/byte_io.h"
#include "formats/crc32.h"

namespace spool::format {

namespace {

// The three structures keep their CRC in the last four bytes.
constexpr size_t kCrcAt = kUnit - sizeof(uint32_t);
static_assert(file_header::kCrc32 == kCrcAt && record_header::kCrc32 == kCrcAt &&
              footer::kCrc32 == kCrcAt);

// An index entry is the offset followed by the header's bytes from kType up to the CRC.
constexpr size_t kEntryBody = kCrcAt - record_header::kType;
static_assert(index_entry::kType + kEntryBody == kUnit);

void seal(UnitBytes& bytes) {
  store(std::span(bytes), kCrcAt, crc32(std::span(bytes).first(kCrcAt)));
}

}  // namespace

uint64_t FileHeader::dump_id() const {
  return load<uint64_t>(std::as_bytes(std::span(dump_uuid)), 0);
}

std::array<char, 4> record_type(std::string_view name) {
  std::array<char, 4> type{};
  std::copy_n(name.begin(), std::min(name.size(), type.size()), type.begin());
  return type;
}

UnitBytes encode(const FileHeader& header) {
  UnitBytes bytes{};
  const std::span out(bytes);
  store(out, file_header::kMagic, kMagicBytes);
  store(out, file_header::kMajor, header.major);
  store(out, file_header::kMinor, header.minor);
  store(out, file_header::kRequiredFeatures, header.required_features);
  store(out, file_header::kDumpUuid, header.dump_uuid);
  seal(bytes);
  return bytes;
}

UnitBytes encode(const RecordHeader& header) {
  UnitBytes bytes{};
  const std::span out(bytes);
  store(out, record_header::kSync, kSyncBytes);
  store(out, record_header::kType, header.type);
  store(out, record_header::kSequence, header.sequence);
  store(out, record_header::kDumpId, header.dump_id);
  store(out, record_header::kStoredBytes, header.stored_bytes);
  store(out, record_header::kRawBytes, header.raw_bytes);
  store(out, record_header::kPayloadCrc32, header.payload_crc32);
  store(out, record_header::kCodec, header.codec);
  store(out, record_header::kFilter, header.filter);
  store(out, record_header::kGroup, header.group);
  store(out, record_header::kTile, header.tile);
  store(out, record_header::kSampleBegin, header.sample_begin);
  store(out, record_header::kSampleCount, header.sample_count);
  seal(bytes);
  return bytes;
}

UnitBytes encode(const IndexEntry& entry) {
  UnitBytes bytes{};
  const UnitBytes header = encode(entry.header);
  store(std::span(bytes), index_entry::kOffset, entry.offset);
  std::copy_n(header.begin() + record_header::kType, kEntryBody,
              bytes.begin() + index_entry::kType);
  return bytes;
}

UnitBytes encode(const Footer& footer) {
  UnitBytes bytes{};
  const std::span out(bytes);
  store(out, footer::kIndexOffset, footer.index_offset);
  store(out, footer::kFileBytes, footer.file_bytes);
  store(out, footer::kRecordCount, footer.record_count);
  store(out, footer::kDumpId, footer.dump_id);
  store(out, footer::kDataRecordCount, footer.data_record_count);
  store(out, footer::kFlags, footer.flags);
  store(out, footer::kEndMagic, kEndMagicBytes);
  seal(bytes);
  return bytes;
}

FileHeader decode_file_header(std::span<const std::byte> bytes) {
  FileHeader header;
  header.major = load<uint16_t>(bytes, file_header::kMajor);
  header.minor = load<uint16_t>(bytes, file_header::kMinor);
  header.required_features = load<uint32_t>(bytes, file_header::kRequiredFeatures);
  header.dump_uuid = load<std::array<uint8_t, 16>>(bytes, file_header::kDumpUuid);
  return header;
}

RecordHeader decode_record_header(std::span<const std::byte> bytes) {
  RecordHeader header;
  header.type = load<std::array<char, 4>>(bytes, record_header::kType);
  header.sequence = load<uint64_t>(bytes, record_header::kSequence);
  header.dump_id = load<uint64_t>(bytes, record_header::kDumpId);
  header.stored_bytes = load<uint64_t>(bytes, record_header::kStoredBytes);
  header.raw_bytes = load<uint64_t>(bytes, record_header::kRawBytes);
  header.payload_crc32 = load<uint32_t>(bytes, record_header::kPayloadCrc32);
  header.codec = load<uint8_t>(bytes, record_header::kCodec);
  header.filter = load<uint8_t>(bytes, record_header::kFilter);
  header.group = load<uint16_t>(bytes, record_header::kGroup);
  header.tile = load<uint32_t>(bytes, record_header::kTile);
  header.sample_begin = load<uint32_t>(bytes, record_header::kSampleBegin);
  header.sample_count = load<uint32_t>(bytes, record_header::kSampleCount);
  return header;
}

IndexEntry decode_index_entry(std::span<const std::byte> bytes) {
  UnitBytes header{};
  std::copy_n(bytes.begin() + index_entry::kType, kEntryBody,
              header.begin() + record_header::kType);
  return {load<uint64_t>(bytes, index_entry::kOffset), decode_record_header(header)};
}

Footer decode_footer(std::span<const std::byte> bytes) {
  Footer footer;
  footer.index_offset = load<uint64_t>(bytes, footer::kIndexOffset);
  footer.file_bytes = load<uint64_t>(bytes, footer::kFileBytes);
  footer.record_count = load<uint64_t>(bytes, footer::kRecordCount);
  footer.dump_id = load<uint64_t>(bytes, footer::kDumpId);
  footer.data_record_count = load<uint64_t>(bytes, footer::kDataRecordCount);
  footer.flags = load<uint32_t>(bytes, footer::kFlags);
  return footer;
}

}  // namespace spool::format
