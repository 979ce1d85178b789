#include "formats/interchange/zip_directory.h"

#include <algorithm>
#include <set>

#include <zlib.h>

#include "formats/byte_io.h"
#include "formats/checked_math.h"
#include "formats/crc32.h"
#include "formats/other_kinds.h"

namespace spool::interchange {
namespace {

using format::FileHandle;
using format::fits;
using format::load;

constexpr uint32_t kLocalSignature = 0x04034b50;
constexpr uint32_t kCentralSignature = 0x02014b50;
constexpr uint32_t kEndSignature = 0x06054b50;
constexpr uint32_t kEnd64Signature = 0x06064b50;
constexpr uint32_t kLocator64Signature = 0x07064b50;
constexpr size_t kLocalBytes = 30, kCentralBytes = 46, kEndBytes = 22, kEnd64Bytes = 56,
                 kLocatorBytes = 20;
constexpr uint64_t kMaxDirectoryBytes = uint64_t{64} << 20;
// Deflate cannot shrink further than this [zlib manual]; a bigger claim is a bomb or damage.
constexpr uint64_t kMaxDeflateRatio = 1032;
constexpr size_t kPieceBytes = 1 << 18;

struct Directory {
  uint64_t offset = 0, bytes = 0, count = 0;
  uint64_t end = 0;  // where the directory must end
};

Result<std::vector<std::byte>> read(const FileHandle& file, uint64_t at, uint64_t count) {
  std::vector<std::byte> bytes(count);
  SPOOL_TRY(file.read_at(at, bytes));
  return bytes;
}

tl::unexpected<Error> damaged(const FileHandle& file, std::string_view what, uint64_t at) {
  return fail(ErrorCode::kDamage, "{}: {} (byte {}): fetch the file again", file.path().string(),
              what, at);
}

Result<Directory> find_directory64(const FileHandle& file, uint64_t end_at) {
  if (end_at < kLocatorBytes + kEnd64Bytes) return damaged(file, "zip64 directory missing", 0);
  const uint64_t locator_at = end_at - kLocatorBytes;
  SPOOL_ASSIGN(const auto locator, read(file, locator_at, kLocatorBytes));
  if (load<uint32_t>(locator, 0) != kLocator64Signature)
    return damaged(file, "zip64 locator missing", locator_at);
  const uint64_t at = load<uint64_t>(locator, 8);
  if (!fits(at, kEnd64Bytes, locator_at)) return damaged(file, "zip64 end lies outside", at);
  SPOOL_ASSIGN(const auto end, read(file, at, kEnd64Bytes));
  if (load<uint32_t>(end, 0) != kEnd64Signature || load<uint64_t>(end, 4) != locator_at - at - 12)
    return damaged(file, "zip64 end is not where the locator says", at);
  if (load<uint32_t>(end, 16) != 0 || load<uint32_t>(end, 20) != 0 ||
      load<uint64_t>(end, 24) != load<uint64_t>(end, 32))
    return fail(ErrorCode::kData, "{}: zip of several disks (byte {}): join it first",
                file.path().string(), at);
  return Directory{load<uint64_t>(end, 48), load<uint64_t>(end, 40), load<uint64_t>(end, 32), at};
}

Result<Directory> find_directory(const FileHandle& file, uint64_t file_bytes) {
  const uint64_t tail_bytes = std::min<uint64_t>(file_bytes, kEndBytes + 0xFFFF);
  SPOOL_ASSIGN(const auto tail, read(file, file_bytes - tail_bytes, tail_bytes));
  for (size_t back = kEndBytes; back <= tail.size(); ++back) {
    const size_t at = tail.size() - back;
    if (load<uint32_t>(tail, at) != kEndSignature) continue;
    if (load<uint16_t>(tail, at + 20) != back - kEndBytes) continue;  // comment up to the end
    const uint64_t end_at = file_bytes - back;
    const uint16_t count = load<uint16_t>(tail, at + 10);
    const uint32_t bytes = load<uint32_t>(tail, at + 12), offset = load<uint32_t>(tail, at + 16);
    if (count == 0xFFFF || bytes == 0xFFFFFFFF || offset == 0xFFFFFFFF)
      return find_directory64(file, end_at);
    if (load<uint16_t>(tail, at + 4) != 0 || load<uint16_t>(tail, at + 6) != 0 ||
        load<uint16_t>(tail, at + 8) != count)
      return fail(ErrorCode::kData, "{}: zip of several disks (byte {}): join it first",
                  file.path().string(), end_at);
    return Directory{offset, bytes, count, end_at};
  }
  std::vector<std::byte> start(std::min<uint64_t>(file_bytes, 32));
  SPOOL_TRY(file.read_at(0, start));
  SPOOL_TRY(format::refuse_other_kind(file.path().string(), start, "a zip archive",
                                      "save its arrays with numpy.savez",
                                      "give a folder of EXR images to --from exr-folder"));
  if (start.size() < 4 || format::kind_of(start) == "a zip archive")
    return damaged(file, "no zip directory at the end, the file is cut", file_bytes);
  return fail(ErrorCode::kData,
              "{}: is not a zip archive (wrong first bytes): give an .npz or .zip",
              file.path().string());
}

// Replaces the fields that are all ones by those of the zip64 extra field, in their fixed order.
bool widen(std::span<const std::byte> extra, ZipMember& member, uint64_t& local_offset) {
  const bool needed =
      member.bytes == 0xFFFFFFFF || member.stored_bytes == 0xFFFFFFFF || local_offset == 0xFFFFFFFF;
  for (size_t at = 0; fits(at, 4, extra.size());) {
    const uint16_t id = load<uint16_t>(extra, at), size = load<uint16_t>(extra, at + 2);
    if (!fits(at + 4, size, extra.size())) return false;
    if (id == 0x0001 && needed) {
      size_t inside = 0;
      for (uint64_t* field : {&member.bytes, &member.stored_bytes, &local_offset}) {
        if (*field != 0xFFFFFFFF) continue;
        if (!fits(inside, 8, size)) return false;
        *field = load<uint64_t>(extra, at + 4 + inside);
        inside += 8;
      }
      return true;
    }
    at += size_t{4} + size;
  }
  return !needed;
}

Result<void> locate_data(const FileHandle& file, uint64_t local_offset, uint64_t directory_at,
                         ZipMember& member) {
  if (!fits(local_offset, kLocalBytes, directory_at))
    return damaged(file, fmt::format("member {} lies outside", member.name), local_offset);
  SPOOL_ASSIGN(const auto local, read(file, local_offset, kLocalBytes));
  const uint16_t name_bytes = load<uint16_t>(local, 26), extra_bytes = load<uint16_t>(local, 28);
  const uint64_t header_bytes = uint64_t{kLocalBytes} + name_bytes + extra_bytes;
  if (load<uint32_t>(local, 0) != kLocalSignature || name_bytes != member.name.size() ||
      !fits(local_offset, header_bytes, directory_at) ||
      load<uint16_t>(local, 8) != (member.deflated ? 8 : 0))
    return damaged(file, fmt::format("header of member {} is damaged", member.name), local_offset);
  SPOOL_ASSIGN(const auto name, read(file, local_offset + kLocalBytes, name_bytes));
  if (std::memcmp(name.data(), member.name.data(), name.size()) != 0)
    return damaged(file, fmt::format("member {} has another name in its header", member.name),
                   local_offset);
  member.data_offset = local_offset + header_bytes;
  if (!fits(member.data_offset, member.stored_bytes, directory_at))
    return damaged(file, fmt::format("member {} is cut", member.name), member.data_offset);
  return {};
}

Result<void> check_no_overlap(const FileHandle& file, const std::vector<ZipMember>& members) {
  std::vector<const ZipMember*> order;
  for (const ZipMember& member : members)
    order.push_back(&member);
  std::sort(order.begin(), order.end(),
            [](const ZipMember* a, const ZipMember* b) { return a->data_offset < b->data_offset; });
  for (size_t i = 1; i < order.size(); ++i) {
    if (order[i - 1]->stored_bytes > order[i]->data_offset - order[i - 1]->data_offset)
      return damaged(file,
                     fmt::format("members {} and {} overlap", order[i - 1]->name, order[i]->name),
                     order[i]->data_offset);
  }
  return {};
}

// Ends the zlib stream however the function is left.
struct Inflater {
  z_stream stream{};
  bool ready = inflateInit2(&stream, -MAX_WBITS) == Z_OK;
  ~Inflater() {
    if (ready) inflateEnd(&stream);
  }
};

// Decodes until the member or `limit` is exhausted; never more than `limit` bytes.
Result<void> decode(const FileHandle& file, const ZipMember& member, uint64_t limit,
                    const ByteSink& sink) {
  std::vector<std::byte> in(kPieceBytes), out(kPieceBytes);
  Inflater inflater;
  if (!inflater.ready) return fail(ErrorCode::kIo, "{}: no memory", file.path().string());
  z_stream& z = inflater.stream;
  uint64_t taken = 0, given = 0;
  bool ended = !member.deflated;
  bool output_waits = false;  // the last call filled `out`: zlib may hold more
  while (given < limit || !ended) {
    if (z.avail_in == 0 && !output_waits) {
      const size_t count =
          static_cast<size_t>(std::min<uint64_t>(in.size(), member.stored_bytes - taken));
      if (count == 0) break;
      SPOOL_TRY(file.read_at(member.data_offset + taken, std::span(in).first(count)));
      taken += count;
      if (!member.deflated) {
        const size_t useful = static_cast<size_t>(std::min<uint64_t>(count, limit - given));
        given += useful;
        SPOOL_TRY(sink(std::span(in).first(useful)));
        continue;
      }
      z.next_in = reinterpret_cast<Bytef*>(in.data());
      z.avail_in = static_cast<uInt>(count);
    }
    z.next_out = reinterpret_cast<Bytef*>(out.data());
    z.avail_out = static_cast<uInt>(out.size());
    const int status = inflate(&z, Z_NO_FLUSH);
    const size_t produced = out.size() - z.avail_out;
    output_waits = z.avail_out == 0;
    if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR)
      return damaged(file, fmt::format("deflate data of member {} are damaged", member.name),
                     member.data_offset);
    if (produced > limit - given) {
      if (limit < member.bytes) {  // only the start was asked for
        return sink(std::span(out).first(static_cast<size_t>(limit - given)));
      }
      return damaged(file, fmt::format("member {} holds more than its size", member.name),
                     member.data_offset);
    }
    given += produced;
    SPOOL_TRY(sink(std::span(out).first(produced)));
    if (status == Z_STREAM_END) {
      ended = true;
      break;
    }
    if (limit < member.bytes && given == limit) return {};
  }
  if (given != limit || !ended || (member.deflated && (taken != member.stored_bytes || z.avail_in)))
    return damaged(file, fmt::format("member {} holds {} bytes of {}", member.name, given, limit),
                   member.data_offset);
  return {};
}

struct Entry {
  ZipMember member;
  uint64_t local_offset = 0;
  size_t bytes = 0;  // in the directory
};

// The entry at byte `at` of the directory, whose signature is right.
Result<Entry> read_entry(const FileHandle& file, const Directory& directory,
                         std::span<const std::byte> bytes, size_t at) {
  const uint16_t flags = load<uint16_t>(bytes, at + 8), method = load<uint16_t>(bytes, at + 10);
  const uint16_t name_bytes = load<uint16_t>(bytes, at + 28);
  const uint16_t extra_bytes = load<uint16_t>(bytes, at + 30);
  const uint16_t comment_bytes = load<uint16_t>(bytes, at + 32);
  const size_t tail_bytes = size_t{name_bytes} + extra_bytes + comment_bytes;
  if (!fits(at + kCentralBytes, tail_bytes, bytes.size()))
    return damaged(file, "zip directory entry is cut", directory.offset + at);
  Entry entry;
  entry.bytes = kCentralBytes + tail_bytes;
  ZipMember& member = entry.member;
  member.name.assign(reinterpret_cast<const char*>(bytes.data()) + at + kCentralBytes, name_bytes);
  // Names go into messages and onto terminals.
  if (!std::all_of(member.name.begin(), member.name.end(),
                   [](char c) { return c >= ' ' && c <= '~'; }))
    return fail(ErrorCode::kData,
                "{}: member name is not printable ASCII (byte {}): save it under another name",
                file.path().string(), directory.offset + at);
  if ((flags & 1) != 0)
    return fail(ErrorCode::kData, "{}: member {} is encrypted (byte {}): decrypt it first",
                file.path().string(), member.name, directory.offset + at);
  if (method != 0 && method != 8)
    return fail(ErrorCode::kData, "{}: member {} uses zip method {} (byte {}): store or deflate it",
                file.path().string(), member.name, method, directory.offset + at);
  member.deflated = method == 8;
  member.crc32 = load<uint32_t>(bytes, at + 16);
  member.stored_bytes = load<uint32_t>(bytes, at + 20);
  member.bytes = load<uint32_t>(bytes, at + 24);
  entry.local_offset = load<uint32_t>(bytes, at + 42);
  if (!widen(bytes.subspan(at + kCentralBytes + name_bytes, extra_bytes), member,
             entry.local_offset))
    return damaged(file, fmt::format("zip64 sizes of member {} are missing", member.name),
                   directory.offset + at);
  if (member.deflated ? member.bytes / kMaxDeflateRatio > member.stored_bytes
                      : member.bytes != member.stored_bytes)
    return damaged(file, fmt::format("member {} cannot hold {} bytes", member.name, member.bytes),
                   directory.offset + at);
  return entry;
}

}  // namespace

Result<std::vector<ZipMember>> read_zip_directory(const FileHandle& file) {
  SPOOL_ASSIGN(const uint64_t file_bytes, file.size());
  SPOOL_ASSIGN(const Directory directory, find_directory(file, file_bytes));
  if (!fits(directory.offset, directory.bytes, directory.end) ||
      directory.offset + directory.bytes != directory.end || directory.bytes > kMaxDirectoryBytes ||
      directory.count > directory.bytes / kCentralBytes)
    return damaged(file, "zip directory does not end where it must", directory.offset);
  SPOOL_ASSIGN(const auto bytes, read(file, directory.offset, directory.bytes));
  std::vector<ZipMember> members;
  std::set<std::string> names;
  size_t at = 0;
  for (uint64_t i = 0; i < directory.count; ++i) {
    if (!fits(at, kCentralBytes, bytes.size()) || load<uint32_t>(bytes, at) != kCentralSignature)
      return damaged(file, fmt::format("zip directory entry {} is damaged", i),
                     directory.offset + at);
    SPOOL_ASSIGN(Entry entry, read_entry(file, directory, bytes, at));
    ZipMember& member = entry.member;
    if (!names.insert(member.name).second)
      return fail(ErrorCode::kData, "{}: member {} occurs twice (byte {}): save each array once",
                  file.path().string(), member.name, directory.offset + at);
    SPOOL_TRY(locate_data(file, entry.local_offset, directory.offset, member));
    members.push_back(std::move(member));
    at += entry.bytes;
  }
  if (at != bytes.size())
    return damaged(file, "zip directory is longer than its entries", directory.offset + at);
  SPOOL_TRY(check_no_overlap(file, members));
  return members;
}

Result<void> decode_member(const FileHandle& file, const ZipMember& member, const ByteSink& sink) {
  uint32_t crc = 0;
  SPOOL_TRY(decode(file, member, member.bytes, [&](std::span<const std::byte> piece) {
    crc = format::crc32(piece, crc);
    return sink(piece);
  }));
  if (crc != member.crc32)
    return damaged(file, fmt::format("checksum of member {} is wrong", member.name),
                   member.data_offset);
  return {};
}

Result<std::vector<std::byte>> decode_member_start(const FileHandle& file, const ZipMember& member,
                                                   size_t count) {
  std::vector<std::byte> start;
  const uint64_t limit = std::min<uint64_t>(count, member.bytes);
  SPOOL_TRY(decode(file, member, limit, [&](std::span<const std::byte> piece) -> Result<void> {
    start.insert(start.end(), piece.begin(), piece.end());
    return {};
  }));
  return start;
}

}  // namespace spool::interchange
