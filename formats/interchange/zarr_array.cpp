#include "formats/interchange/zarr_array.h"

#include <algorithm>
#include <cstring>

#include <blosc.h>
#include <fmt/format.h>
#include <zlib.h>
#include <zstd.h>

#include "formats/bounded_json.h"
#include "formats/checked_math.h"
#include "formats/interchange/npz_members.h"

namespace spool::interchange {
namespace {

using nlohmann::json;

constexpr uint64_t kMaxJsonBytes = 65536;
constexpr uint64_t kMaxChunkBytes = uint64_t{512} << 20;
constexpr uint64_t kMaxAxis = uint64_t{1} << 31;

// Little-endian numbers and their bytes.
constexpr std::pair<std::string_view, uint64_t> kTypes[] = {
    {"|u1", 1}, {"<f2", 2}, {"<f4", 4}, {"<i4", 4}};

Result<std::vector<uint64_t>> axes_of(const json& about, const char* key, const std::string& name) {
  const auto found = about.find(key);
  std::vector<uint64_t> axes;
  const bool list =
      found != about.end() && found->is_array() && !found->empty() && found->size() <= 8;
  for (size_t i = 0; list && i < found->size(); ++i) {
    const json& axis = (*found)[i];
    if (!axis.is_number_unsigned() || axis.get<uint64_t>() == 0 || axis.get<uint64_t>() > kMaxAxis)
      break;
    axes.push_back(axis.get<uint64_t>());
  }
  if (!list || axes.size() != found->size())
    return fail(ErrorCode::kData, "{}: {} is not a list of sizes: not a Zarr v2 array", name, key);
  return axes;
}

Result<ChunkCompressor> compressor_of(const json& about, const std::string& name) {
  const auto found = about.find("compressor");
  if (found == about.end() || found->is_null()) return ChunkCompressor::kNone;
  const json id = found->is_object() && found->contains("id") ? (*found)["id"] : json();
  if (id == "blosc") return ChunkCompressor::kBlosc;
  if (id == "zstd") return ChunkCompressor::kZstd;
  if (id == "zlib") return ChunkCompressor::kZlib;
  return fail(ErrorCode::kData, "{}: compressor {}: store it with blosc, zstd, zlib or none", name,
              id.dump(-1, ' ', true, json::error_handler_t::replace));
}

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

// Decodes `stored` into all of `out`, whose size is known from the array's shape; kDamage when it
// gives another number of bytes. `name` opens the message.
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

}  // namespace

uint64_t ZarrArray::item_bytes() const {
  for (const auto& [code, bytes] : kTypes)
    if (type == code) return bytes;
  return 0;
}

uint64_t ZarrArray::chunk_values() const {
  uint64_t values = 1;
  for (uint64_t axis : chunks)
    values *= axis;
  return values;
}

std::optional<uint64_t> ZarrArray::decoded_bytes(bool sequence) const {
  std::optional<uint64_t> bytes = item_bytes();
  for (size_t i = 0; i < shape.size() && bytes; ++i) {
    const uint64_t count = i == 0 && sequence ? 1 : format::divide_up(shape[i], chunks[i]);
    const auto axis = format::checked_multiply(count, chunks[i]);
    bytes = axis ? format::checked_multiply(*bytes, *axis) : std::nullopt;
  }
  return bytes;
}

Result<ZarrZip> ZarrZip::open(const std::filesystem::path& path, const Expansion& expansion) {
  ZarrZip zip;
  SPOOL_ASSIGN(zip.file_, format::FileHandle::open(path, format::OpenMode::kRead));
  zip.expansion_ = expansion;
  SPOOL_ASSIGN(zip.file_bytes_, zip.file_.size());
  SPOOL_ASSIGN(zip.members_, read_zip_directory(zip.file_));
  std::sort(zip.members_.begin(), zip.members_.end(),
            [](const ZipMember& a, const ZipMember& b) { return a.name < b.name; });
  if (zip.find("zarr.json") != nullptr)
    return fail(ErrorCode::kData, "{}: Zarr v3 store: convert with zarr 2 layout", path.string());
  if (zip.find(".zgroup") == nullptr)
    return fail(ErrorCode::kData, "{}: no .zgroup in the zip: not a Zarr v2 store", path.string());
  return zip;
}

const ZipMember* ZarrZip::find(const std::string& name) const {
  const auto at = std::lower_bound(
      members_.begin(), members_.end(), name,
      [](const ZipMember& member, const std::string& n) { return member.name < n; });
  return at != members_.end() && at->name == name ? &*at : nullptr;
}

bool ZarrZip::has(const std::string& array) const {
  return find(array + "/.zarray") != nullptr;
}

Result<std::vector<std::byte>> ZarrZip::member_bytes(const ZipMember& member,
                                                     uint64_t limit) const {
  if (member.bytes > limit)
    return fail(ErrorCode::kData, "{}: {}: {} bytes are more than the limit of {}",
                file_.path().string(), member.name, member.bytes, limit);
  std::vector<std::byte> bytes;
  SPOOL_TRY(decode_member(file_, member, [&](std::span<const std::byte> piece) -> Result<void> {
    bytes.insert(bytes.end(), piece.begin(), piece.end());
    return {};
  }));
  return bytes;
}

Result<ZarrArray> ZarrZip::array(const std::string& array_name) const {
  ZarrArray array;
  array.name = array_name;
  const std::string name = fmt::format("{}: {}", file_.path().string(), array_name);
  const ZipMember* member = find(array_name + "/.zarray");
  if (member == nullptr) return fail(ErrorCode::kData, "{}: no such array in the store", name);
  SPOOL_ASSIGN(const auto text, member_bytes(*member, kMaxJsonBytes));
  const json about =
      format::parse_json({reinterpret_cast<const char*>(text.data()), text.size()}, kMaxJsonBytes);
  if (!about.is_object() || about.value("zarr_format", json()) != 2)
    return fail(ErrorCode::kData, "{}: .zarray is not of Zarr v2: convert with zarr 2 layout",
                name);
  const json type = about.value("dtype", json());
  array.type = type.is_string() ? type.get<std::string>() : "";
  if (array.item_bytes() == 0)
    return fail(ErrorCode::kData, "{}: dtype {} is not taken: store |u1, <f2, <f4 or <i4", name,
                type.dump(-1, ' ', true, json::error_handler_t::replace));
  if (about.value("order", json("C")) != "C")
    return fail(ErrorCode::kData, "{}: Fortran order: store it in C order", name);
  if (about.contains("filters") && !about["filters"].is_null() && !about["filters"].empty())
    return fail(ErrorCode::kData, "{}: filters are not taken: store it without", name);
  const json separator = about.value("dimension_separator", json("."));
  if (separator != "." && separator != "/")
    return fail(ErrorCode::kData, "{}: dimension_separator is neither . nor /", name);
  array.separator = separator.get<std::string>();
  SPOOL_ASSIGN(array.shape, axes_of(about, "shape", name));
  SPOOL_ASSIGN(array.chunks, axes_of(about, "chunks", name));
  if (array.shape.size() != array.chunks.size())
    return fail(ErrorCode::kData, "{}: shape {} has other axes than chunks {}", name,
                shape_text(array.shape), shape_text(array.chunks));
  uint64_t bytes = array.item_bytes();
  for (uint64_t axis : array.chunks) {
    const auto more = format::checked_multiply(bytes, axis);
    if (!more || *more > kMaxChunkBytes)
      return fail(ErrorCode::kData, "{}: chunks {} exceed {} MiB: store smaller chunks", name,
                  shape_text(array.chunks), kMaxChunkBytes >> 20);
    bytes = *more;
  }
  SPOOL_TRY(expansion_.check(fmt::format("{}: chunks of {}", name, shape_text(array.chunks)), bytes,
                             file_bytes_));
  SPOOL_ASSIGN(array.compressor, compressor_of(about, name));
  return array;
}

Result<std::vector<std::byte>> ZarrZip::chunk(const ZarrArray& array,
                                              const std::vector<uint64_t>& index) const {
  const std::string key = fmt::format("{}/{}", array.name, fmt::join(index, array.separator));
  const ZipMember* member = find(key);
  if (member == nullptr)
    return fail(ErrorCode::kDamage, "{}: {} missing: the file is incomplete", file_.path().string(),
                key);
  const uint64_t bytes = array.chunk_values() * array.item_bytes();
  SPOOL_ASSIGN(const auto stored, member_bytes(*member, bytes + bytes / 8 + 65536));
  std::vector<std::byte> plain(static_cast<size_t>(bytes));
  SPOOL_TRY(decode_chunk(array.compressor, stored, plain,
                         fmt::format("{}: {}", file_.path().string(), key)));
  return plain;
}

}  // namespace spool::interchange
