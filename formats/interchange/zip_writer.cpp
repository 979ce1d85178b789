#include "formats/interchange/zip_writer.h"

#include <algorithm>

#include <zlib.h>

namespace spool::interchange {
namespace {

constexpr uint64_t kAllOnes32 = 0xFFFFFFFF;
constexpr uint16_t kDosDate = (1 << 5) | 1;  // 1980-01-01: equal input gives equal bytes

// Little-endian fields one after the other.
class Fields {
 public:
  Fields& u16(uint64_t value) { return put(value, 2); }
  Fields& u32(uint64_t value) { return put(value, 4); }
  Fields& u64(uint64_t value) { return put(value, 8); }
  Fields& text(std::string_view value) {
    for (char c : value)
      bytes_.push_back(static_cast<std::byte>(c));
    return *this;
  }
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  Fields& put(uint64_t value, int count) {
    for (int i = 0; i < count; ++i)
      bytes_.push_back(static_cast<std::byte>(value >> (8 * i)));
    return *this;
  }
  std::vector<std::byte> bytes_;
};

bool is_large(uint64_t value) {
  return value >= kAllOnes32;
}

uint64_t local_bytes(const PlannedMember& member) {
  return 30 + member.name.size() + (is_large(member.bytes) ? 20 : 0);
}

std::vector<std::byte> local_header(const PlannedMember& member, uint32_t crc) {
  const bool large = is_large(member.bytes);
  const uint64_t size = large ? kAllOnes32 : member.bytes;
  Fields fields;
  fields.u32(0x04034b50).u16(large ? 45 : 20).u16(0).u16(0).u16(0).u16(kDosDate);
  fields.u32(crc).u32(size).u32(size).u16(member.name.size()).u16(large ? 20 : 0);
  fields.text(member.name);
  if (large) fields.u16(1).u16(16).u64(member.bytes).u64(member.bytes);
  return fields.bytes();
}

void add_entry(Fields& fields, const PlannedMember& member, uint32_t crc) {
  const bool large = is_large(member.bytes), far = is_large(member.header_offset);
  const uint64_t size = large ? kAllOnes32 : member.bytes;
  const uint64_t extra = (large ? 16 : 0) + (far ? 8 : 0);
  fields.u32(0x02014b50).u16(45).u16(large || far ? 45 : 20).u16(0).u16(0).u16(0).u16(kDosDate);
  fields.u32(crc).u32(size).u32(size).u16(member.name.size()).u16(extra ? extra + 4 : 0);
  fields.u16(0).u16(0).u16(0).u32(0).u32(far ? kAllOnes32 : member.header_offset);
  fields.text(member.name);
  if (extra) fields.u16(1).u16(extra);
  if (large) fields.u64(member.bytes).u64(member.bytes);
  if (far) fields.u64(member.header_offset);
}

Result<uint32_t> checksum(const format::FileHandle& file, const PlannedMember& member) {
  std::vector<std::byte> buffer(1 << 20);
  uLong crc = 0;
  for (uint64_t at = 0; at < member.bytes;) {
    const size_t count = static_cast<size_t>(std::min<uint64_t>(buffer.size(), member.bytes - at));
    SPOOL_TRY(file.read_at(member.data_offset + at, std::span(buffer).first(count)));
    crc = ::crc32_z(crc, reinterpret_cast<const Bytef*>(buffer.data()), count);
    at += count;
  }
  return static_cast<uint32_t>(crc);
}

}  // namespace

uint64_t plan_zip(std::vector<PlannedMember>& members) {
  uint64_t at = 0;
  for (PlannedMember& member : members) {
    member.header_offset = at;
    member.data_offset = at + local_bytes(member);
    at = member.data_offset + member.bytes;
  }
  return at;
}

Result<void> finish_zip(format::FileHandle& file, const std::vector<PlannedMember>& members) {
  Fields directory;
  uint64_t at = 0;
  for (const PlannedMember& member : members) {
    SPOOL_ASSIGN(const uint32_t crc, checksum(file, member));
    SPOOL_TRY(file.write_at(member.header_offset, local_header(member, crc)));
    add_entry(directory, member, crc);
    at = member.data_offset + member.bytes;
  }
  const uint64_t bytes = directory.bytes().size();
  Fields end;
  if (is_large(at)) {
    end.u32(0x06064b50).u64(44).u16(45).u16(45).u32(0).u32(0).u64(members.size());
    end.u64(members.size()).u64(bytes).u64(at);
    end.u32(0x07064b50).u32(0).u64(at + bytes).u32(1);
  }
  end.u32(0x06054b50).u16(0).u16(0).u16(members.size()).u16(members.size());
  end.u32(bytes).u32(is_large(at) ? kAllOnes32 : at).u16(0);
  SPOOL_TRY(file.write_at(at, directory.bytes()));
  return file.write_at(at + bytes, end.bytes());
}

}  // namespace spool::interchange
