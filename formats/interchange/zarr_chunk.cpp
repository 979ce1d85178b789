#include "formats/interchange/zarr_chunk.h"

#include <cstring>

#include <blosc.h>
#include <zlib.h>
#include <zstd.h>

namespace spool::interchange {
namespace {

bool decode_blosc(std::span<const std::byte> stored, std::span<std::byte> out) {
  size_t bytes = 0;
  // Verifies the header and that `stored` is all of the buffer, before the decoder reads it.
  if (blosc_cbuffer_validate(stored.data(), stored.size(), &bytes) != 0 || bytes != out.size())
    return false;
  const int given = blosc_decompress_ctx(stored.data(), out.data(), out.size(), 1);
  return given >= 0 && static_cast<size_t>(given) == out.size();
}

bool decode_zstd(std::span<const std::byte> stored, std::span<std::byte> out) {
  const size_t given = ZSTD_decompress(out.data(), out.size(), stored.data(), stored.size());
  return ZSTD_isError(given) == 0 && given == out.size();
}

bool decode_zlib(std::span<const std::byte> stored, std::span<std::byte> out) {
  uLongf given = out.size();
  return uncompress(reinterpret_cast<Bytef*>(out.data()), &given,
                    reinterpret_cast<const Bytef*>(stored.data()), stored.size()) == Z_OK &&
         given == out.size();
}

}  // namespace

Result<void> decode_chunk(ChunkCompressor compressor, std::span<const std::byte> stored,
                          std::span<std::byte> out, std::string_view name) {
  bool decoded = false;
  switch (compressor) {
    case ChunkCompressor::kNone:
      decoded = stored.size() == out.size();
      if (decoded) std::memcpy(out.data(), stored.data(), out.size());
      break;
    case ChunkCompressor::kBlosc:
      decoded = decode_blosc(stored, out);
      break;
    case ChunkCompressor::kZstd:
      decoded = decode_zstd(stored, out);
      break;
    case ChunkCompressor::kZlib:
      decoded = decode_zlib(stored, out);
      break;
  }
  if (decoded) return {};
  return fail(ErrorCode::kDamage,
              "{}: {} bytes do not decode to the {} of its shape: the file is damaged", name,
              stored.size(), out.size());
}

}  // namespace spool::interchange
