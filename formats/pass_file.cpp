#include "formats/pass_file.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <numeric>
#include <vector>

#include <zlib.h>

#include "formats/chunk_codec.h"

namespace spool::format {

namespace {

namespace fs = std::filesystem;

uint32_t pieces_of(const PassManifest& manifest) {
  return (manifest.height + kPieceRows - 1) / kPieceRows;
}

uint64_t plain_bytes(const PassManifest& manifest, uint32_t piece) {
  const uint32_t rows = std::min(kPieceRows, manifest.height - piece * kPieceRows);
  return uint64_t{4} * manifest.width * rows;
}

tl::unexpected<Error> unreadable(const PassEntry& entry) {
  return fail(ErrorCode::kIo, "{}: cannot be read", entry.file.string());
}

tl::unexpected<Error> damaged(const PassEntry& entry, const std::string& what) {
  return fail(ErrorCode::kDamage,
              "{}: damaged ({}): run the recorder again, it renders the pass anew",
              entry.file.string(), what);
}

// Sizes of the pieces, [channel][piece], none larger than what it holds.
Result<std::vector<uint32_t>> read_sizes(const PassManifest& manifest, const PassEntry& entry,
                                         uint32_t channels, std::ifstream& stream) {
  const uint32_t pieces = pieces_of(manifest);
  std::vector<uint32_t> sizes(size_t{channels} * pieces);
  if (!stream.read(reinterpret_cast<char*>(sizes.data()),
                   static_cast<std::streamsize>(4 * sizes.size())))
    return damaged(entry, "cut in its table of pieces");
  for (size_t i = 0; i < sizes.size(); ++i) {
    if (sizes[i] > plain_bytes(manifest, static_cast<uint32_t>(i % pieces)))
      return damaged(entry, fmt::format("piece {} is larger than its rows", i));
  }
  return sizes;
}

Result<uint64_t> expected_bytes(const PassManifest& manifest, const PassEntry& entry,
                                uint32_t channels) {
  if (!entry.packed) return uint64_t{4} * channels * manifest.width * manifest.height;
  std::ifstream stream(entry.file, std::ios::binary);
  SPOOL_ASSIGN(const std::vector<uint32_t> sizes, read_sizes(manifest, entry, channels, stream));
  return std::accumulate(sizes.begin(), sizes.end(), uint64_t{4} * sizes.size());
}

Result<void> read_piece(const PassManifest& manifest, const PassEntry& entry, uint32_t piece,
                        uint32_t stored_bytes, std::ifstream& stream,
                        std::vector<std::byte>& plain) {
  plain.resize(plain_bytes(manifest, piece));
  std::vector<std::byte> stored(stored_bytes);
  if (!stream.read(reinterpret_cast<char*>(stored.data()), stored_bytes)) return unreadable(entry);
  if (stored.size() == plain.size()) {
    plain = std::move(stored);
    return {};
  }
  const auto decoded = decode_payload(Codec::kZstd, Filter::kByteShuffle, stored, 4, plain);
  if (!decoded) return damaged(entry, decoded.error().what);
  return {};
}

}  // namespace

Result<void> verify_pass_file(const PassManifest& manifest, const PassEntry& entry,
                              uint32_t channels) {
  const std::string name = entry.file.string();
  std::error_code code;
  const uintmax_t size = fs::file_size(entry.file, code);
  if (code) {
    return fail(ErrorCode::kDamage, "{}: {}: run the recorder again, it renders what is missing",
                name, code.message());
  }
  SPOOL_ASSIGN(const uint64_t expected, expected_bytes(manifest, entry, channels));
  if (size != expected) {
    return fail(ErrorCode::kDamage,
                "{}: {} bytes instead of {} ({} planes of {}x{}): run the recorder again", name,
                size, expected, channels, manifest.width, manifest.height);
  }
  std::ifstream stream(entry.file, std::ios::binary);
  std::vector<char> buffer(size_t{1} << 20);
  uLong crc = ::crc32(0, nullptr, 0);
  for (uint64_t left = expected; left > 0;) {
    const auto count = static_cast<std::streamsize>(std::min<uint64_t>(left, buffer.size()));
    if (!stream.read(buffer.data(), count)) return unreadable(entry);
    crc = ::crc32(crc, reinterpret_cast<const Bytef*>(buffer.data()), static_cast<uInt>(count));
    left -= static_cast<uint64_t>(count);
  }
  if (crc != entry.crc32) {
    return damaged(entry, fmt::format("CRC-32 {:08x} instead of {:08x}", crc, entry.crc32));
  }
  return {};
}

Result<void> read_pass_rows(const PassManifest& manifest, const PassEntry& entry, uint32_t channels,
                            uint32_t channel, uint32_t y0, uint32_t y1, std::span<float> values) {
  std::ifstream stream(entry.file, std::ios::binary);
  const uint64_t row = uint64_t{4} * manifest.width;
  if (!entry.packed) {
    stream.seekg(static_cast<std::streamoff>((uint64_t{channel} * manifest.height + y0) * row));
    if (!stream.read(reinterpret_cast<char*>(values.data()),
                     static_cast<std::streamsize>(row * (y1 - y0))))
      return unreadable(entry);
    return {};
  }
  SPOOL_ASSIGN(const std::vector<uint32_t> sizes, read_sizes(manifest, entry, channels, stream));
  const size_t first = size_t{channel} * pieces_of(manifest);
  std::vector<std::byte> plain;
  for (uint32_t piece = y0 / kPieceRows; piece * kPieceRows < y1; ++piece) {
    const size_t at = first + piece;
    const auto before = std::accumulate(
        sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(at), uint64_t{4} * sizes.size());
    stream.seekg(static_cast<std::streamoff>(before));
    SPOOL_TRY(read_piece(manifest, entry, piece, sizes[at], stream, plain));
    const uint32_t top = piece * kPieceRows;
    const uint32_t begin = std::max(y0, top);
    const uint32_t end = std::min(y1, top + kPieceRows);
    std::memcpy(values.data() + size_t{begin - y0} * manifest.width,
                plain.data() + (begin - top) * row, (end - begin) * row);
  }
  return {};
}

}  // namespace spool::format
