#include "formats/interchange/npz_members.h"

#include <algorithm>
#include <optional>

#include "formats/bounded_json.h"
#include "formats/byte_io.h"
#include "formats/checked_math.h"
#include "formats/interchange/layer_names.h"
#include "formats/meta_rules.h"

namespace spool::interchange {
namespace {

using format::FileHandle;
using nlohmann::json;

// UTF-32 code points, padded with NUL, as numpy keeps strings.
std::string from_utf32(std::span<const std::byte> bytes) {
  std::string text;
  for (size_t at = 0; at + 4 <= bytes.size(); at += 4) {
    const uint32_t c = format::load<uint32_t>(bytes, at);
    if (c == 0) break;
    const auto put = [&](uint32_t value) { text += static_cast<char>(value); };
    if (c < 0x80) {
      put(c);
    } else if (c < 0x800) {
      put(0xC0 | c >> 6), put(0x80 | (c & 0x3F));
    } else if (c < 0x10000) {
      put(0xE0 | c >> 12), put(0x80 | (c >> 6 & 0x3F)), put(0x80 | (c & 0x3F));
    } else {
      put(0xF0 | (c >> 18 & 7)), put(0x80 | (c >> 12 & 0x3F)), put(0x80 | (c >> 6 & 0x3F));
      put(0x80 | (c & 0x3F));
    }
  }
  return text;
}

}  // namespace

std::string shape_text(const std::vector<uint64_t>& shape) {
  std::string text = "(";
  for (size_t i = 0; i < shape.size(); ++i)
    text += fmt::format("{}{}", i == 0 ? "" : ",", shape[i]);
  return text + ")";
}

Result<std::vector<NpzMember>> read_npz_members(const FileHandle& file) {
  SPOOL_ASSIGN(std::vector<ZipMember> zips, read_zip_directory(file));
  std::vector<NpzMember> members;
  for (ZipMember& zip : zips) {
    if (!zip.name.ends_with(".npy"))
      return fail(ErrorCode::kData, "{}: member {} is not an array: save with numpy.savez",
                  file.path().string(), zip.name);
    if (zip.name.find('/') != std::string::npos)
      return fail(ErrorCode::kData,
                  "{}: member {} lies in a folder: zip the arrays alone, as numpy.savez does",
                  file.path().string(), zip.name);
    NpzMember member{zip.name.substr(0, zip.name.size() - 4), std::move(zip), {}};
    const std::string name = fmt::format("{}: {}", file.path().string(), member.layer);
    if (!is_layer_name(member.layer))
      return fail(ErrorCode::kData,
                  "{}: not a layer name: use lower-case letters, digits and _, 29 at most", name);
    SPOOL_ASSIGN(const auto start, decode_member_start(file, member.zip, kMaxNpyHeaderBytes));
    SPOOL_ASSIGN(member.header, parse_npy_header(start, name));
    std::optional<uint64_t> bytes = member.header.item_bytes();
    for (uint64_t axis : member.header.shape)
      if (bytes) bytes = format::checked_multiply(*bytes, axis);
    if (!bytes || *bytes != member.zip.bytes - member.header.header_bytes)
      return fail(ErrorCode::kDamage, "{}: shape {} of {} is not {} bytes: fetch the file again",
                  name, shape_text(member.header.shape), member.header.type,
                  member.zip.bytes - member.header.header_bytes);
    members.push_back(std::move(member));
  }
  return members;
}

Result<json> read_npz_meta(const FileHandle& file, const NpzMember& member) {
  const std::string name = fmt::format("{}: meta", file.path().string());
  const std::string& type = member.header.type;
  const bool characters = type == "|u1" && member.header.shape.size() == 1;
  const bool string =
      (type.starts_with("<U") || type.starts_with("|S")) && member.header.shape.empty();
  if (!characters && !string)
    return fail(ErrorCode::kData,
                "{}: {} of shape {}: save np.frombuffer(json.dumps(meta).encode(), 'u1')", name,
                type, shape_text(member.header.shape));
  if (member.zip.bytes > 4 * format::kMaxMetaBytes)
    return fail(ErrorCode::kData, "{}: larger than 1 MiB: shorten it", name);
  std::vector<std::byte> bytes;
  SPOOL_TRY(decode_member(file, member.zip, [&](std::span<const std::byte> piece) -> Result<void> {
    bytes.insert(bytes.end(), piece.begin(), piece.end());
    return {};
  }));
  bytes.erase(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(member.header.header_bytes));
  std::string text = type.starts_with("<U")
                         ? from_utf32(bytes)
                         : std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (type.starts_with("|S")) text.resize(std::min(text.size(), text.find('\0')));
  if (const auto judged = format::check_meta(text); !judged)
    return fail(ErrorCode::kData, "{}: {}: save one JSON object", name, judged.error().what);
  return format::parse_json(text);
}

}  // namespace spool::interchange
