// Small dumps for the tests of formats/: headers, contents that follow from a seed, files as bytes.
#pragma once

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/dump_geometry.h"
#include "formats/spool_writer.h"
#include "tests/support/scratch_folder.h"

namespace spool::format {

using Bytes = std::vector<std::byte>;

using test::ScratchFolder;

// By plain calls: the fuzz targets do this for every input.
inline Bytes read_bytes(const std::filesystem::path& path) {
  Bytes bytes;
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return bytes;
  struct stat info{};
  if (::fstat(fd, &info) == 0) bytes.resize(static_cast<size_t>(info.st_size));
  size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = ::read(fd, bytes.data() + done, bytes.size() - done);
    if (got <= 0) break;
    done += static_cast<size_t>(got);
  }
  ::close(fd);
  bytes.resize(done);
  return bytes;
}

inline void write_bytes(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  for (size_t done = 0; fd >= 0 && done < bytes.size();) {
    const ssize_t put = ::write(fd, bytes.data() + done, bytes.size() - done);
    if (put <= 0) break;
    done += static_cast<size_t>(put);
  }
  if (fd >= 0) ::close(fd);
}

inline constexpr std::array<uint8_t, 16> kFixedUuid = {0, 1, 2,  3,  4,  5,  6,  7,
                                                       8, 9, 10, 11, 12, 13, 14, 15};

inline DumpHeader small_header(uint32_t width, uint32_t height, uint32_t spp, uint32_t block_spp,
                               uint32_t tile_size = 8, DataType type = DataType::kFloat32) {
  DumpHeader header;
  header.width = width;
  header.height = height;
  header.tile_size = tile_size;
  header.spp = spp;
  header.block_spp = block_spp;
  header.sample_order = SampleOrder::kExchangeable;
  header.channels = radiance_channels(type);
  return header;
}

inline void add_group(DumpHeader& header, std::vector<std::string> names, DataType type,
                      Scope scope = Scope::kSample, Semantic semantic = Semantic::kNotStated) {
  const auto group = static_cast<uint16_t>(header.channels.back().group + 1);
  for (std::string& name : names) {
    header.channels.push_back(
        {std::move(name), group, type, static_cast<uint16_t>(semantic), scope});
  }
}

inline uint64_t mix(uint64_t x) {  // splitmix64
  x += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

// Bytes of one block; every bit pattern occurs, NaN and infinity too. A `smooth` one compresses.
inline Bytes block_bytes(const DumpGeometry& geometry, uint16_t group, uint32_t tile,
                         uint32_t block, uint64_t seed, bool smooth) {
  Bytes bytes(geometry.raw_bytes(group, tile, block));
  const uint64_t key = mix(seed ^ mix(group ^ mix(tile ^ mix(block))));
  if (smooth) {
    for (size_t i = 0; i < bytes.size(); ++i)
      bytes[i] = static_cast<std::byte>((key + i / 64) & 0xFF);
    return bytes;
  }
  for (size_t i = 0; i < bytes.size(); i += sizeof(uint64_t)) {
    const uint64_t random = mix(key + i);
    std::memcpy(bytes.data() + i, &random, std::min(sizeof random, bytes.size() - i));
  }
  return bytes;
}

struct MadeDump {
  DumpHeader header;
  WriterOptions options{.uuid = kFixedUuid};
  std::vector<std::string> meta;
  uint64_t seed = 1;
  bool smooth = false;
  uint32_t skip_every = 0;  // leave out every so many blocks
};

inline bool is_skipped(const MadeDump& dump, uint32_t slot) {
  return dump.skip_every != 0 && slot % dump.skip_every == dump.skip_every - 1;
}

inline Result<void> write_blocks(SpoolWriter& writer, const MadeDump& dump) {
  const DumpGeometry geometry(dump.header);
  const auto groups = static_cast<uint16_t>(geometry.groups().size());
  for (uint16_t group = 0; group < groups; ++group) {
    for (uint32_t tile = 0; tile < geometry.groups()[group].tiles; ++tile) {
      for (uint32_t block = 0; block < geometry.groups()[group].blocks; ++block) {
        if (is_skipped(dump, *geometry.slot(group, tile, block))) continue;
        if (writer.has_block(group, tile, block)) continue;
        SPOOL_TRY(writer.write_block(
            group, tile, geometry.block_begin(group, block), geometry.block_count(group, block),
            block_bytes(geometry, group, tile, block, dump.seed, dump.smooth)));
      }
    }
  }
  return {};
}

inline Result<void> make_dump(const std::filesystem::path& path, const MadeDump& dump) {
  SPOOL_ASSIGN(SpoolWriter writer, SpoolWriter::create(path, dump.header, dump.options));
  for (const std::string& text : dump.meta)
    SPOOL_TRY(writer.write_meta(text));
  SPOOL_TRY(write_blocks(writer, dump));
  return writer.finish();
}

// One group of each kind, edge tiles, a short last block.
inline MadeDump rich_dump(bool compressed) {
  MadeDump dump;
  dump.header = small_header(9, 5, 3, 2);
  add_group(dump.header, {"albedo.R", "albedo.G", "albedo.B", "depth.Z"}, DataType::kFloat16,
            Scope::kSample);
  add_group(dump.header, {"film.X", "film.Y"}, DataType::kFloat32, Scope::kPass,
            Semantic::kSampleCoordinate);
  add_group(dump.header, {"reference.R", "reference.G", "reference.B"}, DataType::kFloat32,
            Scope::kPixel, Semantic::kLight);
  add_group(dump.header, {"path.flags"}, DataType::kUint32, Scope::kSample, Semantic::kBits);
  dump.meta = {R"({"renderer":"test","seed":1})"};
  dump.smooth = compressed;
  dump.options.compress = compressed;
  return dump;
}

}  // namespace spool::format
