// One array of a Zarr v2 store inside a zip [ZarrV2]: shape, chunks and their numbers.
//
// Errors: kDamage for chunks that are missing or do not decode, kData for what is not taken
// (Zarr v3, filters, Fortran order, other compressors, big-endian numbers).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/interchange/expansion.h"
#include "formats/interchange/zip_directory.h"
#include "lib/core/error.h"

namespace spool::interchange {

enum class ChunkCompressor { kNone, kBlosc, kZstd, kZlib };

struct ZarrArray {
  std::string name;
  std::string type;  // "<f4", "|u1"
  std::vector<uint64_t> shape;
  std::vector<uint64_t> chunks;  // of one chunk; chunks at the end are stored full-size
  ChunkCompressor compressor = ChunkCompressor::kNone;
  std::string separator = ".";

  uint64_t item_bytes() const;
  uint64_t chunk_values() const;  // at most 2^29, checked when it was read
  // Of all chunks, those at the end as they are stored, without axis 0 of a sequence; empty beyond
  // 64 bits.
  std::optional<uint64_t> decoded_bytes(bool sequence) const;
};

class ZarrZip {
 public:
  // No chunk may be larger than `expansion` of the file allows.
  static Result<ZarrZip> open(const std::filesystem::path& path, const Expansion& expansion);

  const format::FileHandle& file() const { return file_; }
  uint64_t file_bytes() const { return file_bytes_; }
  bool has(const std::string& array) const;
  Result<ZarrArray> array(const std::string& name) const;
  // The values of one chunk, C order; `index` has one number per axis.
  Result<std::vector<std::byte>> chunk(const ZarrArray& array,
                                       const std::vector<uint64_t>& index) const;

 private:
  const ZipMember* find(const std::string& name) const;
  Result<std::vector<std::byte>> member_bytes(const ZipMember& member, uint64_t limit) const;

  format::FileHandle file_;
  uint64_t file_bytes_ = 0;
  Expansion expansion_;
  std::vector<ZipMember> members_;
};

}  // namespace spool::interchange
