// The members of a zip file, by its central directory; stored or deflated, zip64 included.
//
// A hostile file can claim anything: every offset and size is compared with the file before it is
// used, members may not overlap, and a member never gives more bytes than the directory says.
// Sources: the .ZIP File Format Specification (APPNOTE 6.3) [Appnote]; RFC 1951 through zlib.
// Errors: kDamage for a file that is cut or whose checksums disagree, kData for features that are
// refused (encryption, several disks, other methods).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "formats/file_handle.h"
#include "lib/core/error.h"

namespace spool::interchange {

struct ZipMember {
  std::string name;
  bool deflated = false;
  uint32_t crc32 = 0;
  uint64_t stored_bytes = 0;  // in the file
  uint64_t bytes = 0;         // decoded
  uint64_t data_offset = 0;   // of the stored bytes
};

// In directory order. Names are unique.
Result<std::vector<ZipMember>> read_zip_directory(const format::FileHandle& file);

// Hands the decoded bytes to `sink` in pieces; fails unless they are exactly `member.bytes` with
// the right CRC.
using ByteSink = std::function<Result<void>(std::span<const std::byte>)>;
Result<void> decode_member(const format::FileHandle& file, const ZipMember& member,
                           const ByteSink& sink);

// The first min(count, member.bytes) decoded bytes; the CRC is not verified.
Result<std::vector<std::byte>> decode_member_start(const format::FileHandle& file,
                                                   const ZipMember& member, size_t count);

}  // namespace spool::interchange
