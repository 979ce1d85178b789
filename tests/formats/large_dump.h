// A dump of 4096 x 4096 pixels and 64 half-float samples (6.4 GB), or a smaller one, as a sparse
// file: most samples are 0 and take no room on disk.
#pragma once

#include <algorithm>

#include "formats/file_handle.h"
#include "formats/spool_reader.h"
#include "tests/formats/made_dump.h"

namespace spool::format {

// pwrite that leaves holes where a record's payload is 0.
inline ssize_t sparse_pwrite(int fd, const void* data, size_t bytes, off_t offset) {
  constexpr size_t kPage = 4096;
  const auto* at = static_cast<const char*>(data);
  const auto zero = [&](size_t from, size_t to) {
    return std::all_of(at + from, at + to, [](char c) { return c == 0; });
  };
  if (bytes <= 2 * kPage || !zero(kUnit, bytes)) return ::pwrite(fd, data, bytes, offset);
  if (::pwrite(fd, data, kUnit, offset) != static_cast<ssize_t>(kUnit)) return -1;
  if (::pwrite(fd, at + bytes - 1, 1, offset + static_cast<off_t>(bytes) - 1) != 1) return -1;
  return static_cast<ssize_t>(bytes);
}

inline MadeDump large_dump(uint32_t side) {
  MadeDump dump;
  dump.header = small_header(side, side, 64, 4, 64, DataType::kFloat16);
  dump.options.force = true;
  return dump;
}

// Block (tile, block) holds data when its number is a multiple of this.
inline constexpr uint32_t kFilledEvery = 997;

inline bool is_filled(const SpoolReader& reader, uint32_t tile, uint32_t block) {
  return (tile * reader.blocks() + block) % kFilledEvery == 0;
}

inline Result<void> write_large_dump(const std::filesystem::path& path, const MadeDump& dump) {
  FileCalls calls = posix_calls();
  calls.pwrite = sparse_pwrite;
  replace_file_calls(calls);
  const auto write = [&]() -> Result<void> {
    SPOOL_ASSIGN(SpoolWriter writer, SpoolWriter::create(path, dump.header, dump.options));
    const DumpGeometry geometry(dump.header);
    const Bytes zeros(geometry.raw_bytes(0, 0, 0));
    const uint32_t blocks = geometry.groups()[0].blocks;
    for (uint32_t tile = 0; tile < geometry.groups()[0].tiles; ++tile)
      for (uint32_t block = 0; block < blocks; ++block) {
        const bool filled = (tile * blocks + block) % kFilledEvery == 0;
        const Bytes bytes =
            filled ? block_bytes(geometry, 0, tile, block, dump.seed, false) : zeros;
        SPOOL_TRY(writer.write_block(0, tile, geometry.block_begin(0, block),
                                     geometry.block_count(0, block), bytes));
      }
    return writer.finish();
  };
  const auto written = write();
  replace_file_calls(posix_calls());
  return written;
}

}  // namespace spool::format
