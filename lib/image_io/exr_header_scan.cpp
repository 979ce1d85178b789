#include "lib/image_io/exr_header_scan.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include <OpenEXR/ImfCompression.h>

#include "formats/other_kinds.h"
#include "lib/core/visible_text.h"
#include "lib/image_io/exr_chunks.h"
#include "lib/image_io/exr_geometry.h"

namespace spool::exr {
namespace {

static_assert(std::endian::native == std::endian::little, "OpenEXR numbers are little-endian");

constexpr std::size_t kMaxNameBytes = 255;
constexpr std::uint32_t kMagic = 20000630;
constexpr std::uint32_t kTiled = 0x200, kNoImage = 0x800, kMultiPart = 0x1000;  // of the version
constexpr std::uint32_t kLongNames = 0x400;
constexpr std::uint32_t kKnownVersion = 0xFF | kTiled | kLongNames | kNoImage | kMultiPart;
constexpr std::uint64_t kTableEntryBytes = 8;

// Values of these types have one size. Of the others, text and unknown types may have any, and
// lists are checked entry by entry.
const std::map<std::string_view, std::uint64_t>& fixed_sizes() {
  static const std::map<std::string_view, std::uint64_t> sizes = {
      {"box2f", 16},      {"box2i", 16},    {"chromaticities", 32},
      {"compression", 1}, {"double", 8},    {"deepImageState", 1},
      {"envmap", 1},      {"float", 4},     {"int", 4},
      {"keycode", 28},    {"lineOrder", 1}, {"m33d", 72},
      {"m33f", 36},       {"m44d", 128},    {"m44f", 64},
      {"rational", 8},    {"timecode", 8},  {"v2d", 16},
      {"v2f", 8},         {"v2i", 8},       {"v3d", 24},
      {"v3f", 12},        {"v3i", 12},      {"tiledesc", 9}};
  return sizes;
}

// Those that OpenEXR has added since.
std::string_view newer_compression(int number) {
  switch (number) {
    case 10:
    case 11:
      return " (HTJ2K)";
    case 12:
      return " (LJ2K)";
    case 13:
      return " (ZSTD)";
    default:
      return "";
  }
}

template <class T>
T number_at(std::string_view bytes, std::size_t at) {
  T value{};
  if (at + sizeof(T) <= bytes.size()) std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

struct Attribute {
  std::string name, type, value;  // the value of the types that are looked at
};

struct Part {
  PartShape shape;
  std::string name, type;
  std::uint64_t chunk_count = 0;  // as an attribute says
};

class HeaderScan {
 public:
  HeaderScan(const std::filesystem::path& path, std::uint64_t file_bytes)
      : name_(path.string()), file_(path, std::ios::binary), bytes_(file_bytes) {}

  Result<void> run() {
    std::string start = take(8);
    if (number_at<std::uint32_t>(start, 0) != kMagic || start.size() < 4) {
      start += take(24);
      const auto bytes = std::as_bytes(std::span(start));
      const bool recording = format::kind_of(bytes) == "a .spool file";
      SPOOL_TRY(format::refuse_other_kind(
          name_, bytes, "an OpenEXR image",
          recording ? "spool reconstruct makes one of it" : "save its values as an OpenEXR image",
          "convert it, e.g. with oiiotool"));
      return fail(ErrorCode::kData,
                  "{}: is not an OpenEXR image (wrong first bytes): save its values as one", name_);
    }
    if (start.size() < 8) return cut();
    version_ = number_at<std::uint32_t>(start, 4);
    if ((version_ & 0xFF) != 2 || (version_ & ~kKnownVersion) != 0)
      return fail(ErrorCode::kData,
                  "{}: version {} (flags {:#x}) of OpenEXR is unknown here: save it as version 2",
                  name_, version_ & 0xFF, version_ & ~0xFFU);
    const bool several = (version_ & kMultiPart) != 0;
    std::uint64_t table_bytes = 0;
    std::set<std::string> names;
    for (bool ended = false; !ended;) {
      SPOOL_ASSIGN(const std::optional<Part> part, read_header());
      if (part) {
        if (several && (part->name.empty() || !names.insert(part->name).second))
          return fail(ErrorCode::kData,
                      "{}: part {} has {}: give each part a name of its own where it was written",
                      name_, names.size(),
                      part->name.empty() ? "no name" : "the name of an earlier one");
        SPOOL_ASSIGN(const std::uint64_t bytes, check_part(*part));
        table_bytes += bytes;
        if (table_bytes > bytes_) return too_many_chunks();
      }
      ended = !several || !part;
    }
    return table_bytes > bytes_ - at_ ? too_many_chunks() : Result<void>();
  }

 private:
  // The next bytes, fewer where the file ends.
  std::string take(std::uint64_t count) {
    std::string bytes(static_cast<std::size_t>(std::min(count, bytes_ - at_)), '\0');
    file_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(file_.gcount(), 0)));
    at_ += bytes.size();
    return bytes;
  }

  // Up to the next byte 0; nothing when there is none where it must be.
  std::optional<std::string> take_name() {
    std::string text;
    for (int c = 0; text.size() <= kMaxNameBytes && (c = file_.get()) != EOF; text += char(c)) {
      ++at_;
      if (c == 0) return text;
    }
    return std::nullopt;
  }

  // One attribute; an empty name ends a header.
  Result<Attribute> take_attribute() {
    Attribute attribute;
    const auto attribute_name = take_name();
    if (!attribute_name) return cut();
    attribute.name = *attribute_name;
    if (attribute.name.empty()) return attribute;
    const auto type = take_name();
    const std::string size_bytes = take(4);
    if (!type || size_bytes.size() < 4) return cut();
    attribute.type = *type;
    const auto size = number_at<std::int32_t>(size_bytes, 0);
    const std::uint64_t left = bytes_ - at_;
    if (size < 0 || static_cast<std::uint64_t>(size) > left)
      return refuse(attribute, fmt::format("claims {} bytes of {} left", size, left));
    const auto fixed = fixed_sizes().find(attribute.type);
    if (fixed != fixed_sizes().end() && static_cast<std::uint64_t>(size) != fixed->second)
      return refuse(attribute, fmt::format("has {} bytes, not {}", size, fixed->second));
    if (attribute.type == "floatvector" && size % 4 != 0)
      return refuse(attribute, "ends within a number");
    const bool list = attribute.type == "chlist" || attribute.type == "preview" ||
                      attribute.type == "stringvector";
    const bool text = attribute.name == "type" || attribute.name == "name";
    if (fixed != fixed_sizes().end() || list || text) {
      attribute.value = take(static_cast<std::uint64_t>(size));
    } else {
      file_.seekg(size, std::ios::cur);
      at_ += static_cast<std::uint64_t>(size);
    }
    return attribute;
  }

  // The next header; nothing where an empty one ends the list of several parts.
  Result<std::optional<Part>> read_header() {
    Part part;
    for (bool first = true;; first = false) {
      SPOOL_ASSIGN(const Attribute attribute, take_attribute());
      if (attribute.name.empty()) return first ? std::nullopt : std::optional(part);
      SPOOL_TRY(take_in(attribute, part));
    }
  }

  Result<void> take_in(const Attribute& attribute, Part& part) {
    const std::string_view value = attribute.value;
    if (attribute.type == "preview") {
      const std::uint64_t pixels =
          std::uint64_t{number_at<std::uint32_t>(value, 0)} * number_at<std::uint32_t>(value, 4);
      if (value.size() < 8 || (value.size() - 8) % 4 != 0 || pixels != (value.size() - 8) / 4)
        return refuse(attribute, fmt::format("has {} bytes for {} pixels", value.size(), pixels));
    } else if (attribute.type == "stringvector") {
      for (std::size_t at = 0; at < value.size();) {
        const auto length = number_at<std::int32_t>(value, at);
        if (value.size() - at < 4 || length < 0 ||
            static_cast<std::size_t>(length) > value.size() - at - 4)
          return refuse(attribute, "claims a text longer than itself");
        at += 4 + static_cast<std::size_t>(length);
      }
    } else if (attribute.type == "chlist") {
      SPOOL_ASSIGN(const std::uint64_t bytes, bytes_of_channels(attribute));
      if (attribute.name == "channels") part.shape.pixel_bytes = bytes;
    } else if (attribute.name == "dataWindow" && attribute.type == "box2i") {
      part.shape.width =
          std::int64_t{number_at<std::int32_t>(value, 8)} - number_at<std::int32_t>(value, 0) + 1;
      part.shape.height =
          std::int64_t{number_at<std::int32_t>(value, 12)} - number_at<std::int32_t>(value, 4) + 1;
    } else if (attribute.name == "tiles" && attribute.type == "tiledesc") {
      part.shape.tile_width = number_at<std::uint32_t>(value, 0);
      part.shape.tile_height = number_at<std::uint32_t>(value, 4);
      const auto mode = number_at<std::uint8_t>(value, 8);
      part.shape.level_mode = mode & 0x0F;
      part.shape.round_up = (mode & 0xF0) != 0;
      if (part.shape.tile_width == 0 || part.shape.tile_height == 0)
        return refuse(attribute, "has empty tiles");
    } else if (attribute.name == "compression" && attribute.type == "compression") {
      part.shape.compression = number_at<std::uint8_t>(value, 0);
      if (part.shape.compression >= Imf::NUM_COMPRESSION_METHODS)
        return fail(ErrorCode::kData,
                    "{}: compression {}{} is unknown here: save it with zip where it was made",
                    name_, part.shape.compression, newer_compression(part.shape.compression));
    } else if (attribute.name == "chunkCount" && attribute.type == "int") {
      part.chunk_count = static_cast<std::uint64_t>(std::max(0, number_at<std::int32_t>(value, 0)));
    } else if (attribute.name == "type" && attribute.type == "string") {
      part.type = attribute.value;
    } else if (attribute.name == "name" && attribute.type == "string") {
      part.name = attribute.value;
    }
    return {};
  }

  // Entries of a name, its end, and 16 bytes; one byte 0 after the last.
  Result<std::uint64_t> bytes_of_channels(const Attribute& attribute) const {
    const std::string_view value = attribute.value;
    std::uint64_t bytes = 0;
    for (std::size_t at = 0; at < value.size();) {
      const std::size_t end = value.find('\0', at);
      if (end == at) {
        if (at + 1 == value.size()) return bytes;
        break;
      }
      if (end == std::string_view::npos || end - at > kMaxNameBytes || value.size() - end < 17)
        break;
      const auto type = number_at<std::int32_t>(value, end + 1);
      if (type < 0 || type > 2)
        return fail(ErrorCode::kData,
                    "{}: channel {} has type {}, which is unknown here: save it as half or float",
                    name_, printable_ascii(value.substr(at, end - at)), type);
      bytes += type == 1 ? 2 : 4;  // HALF is 1
      at = end + 17;
    }
    return refuse(attribute, "is no list of channels");
  }

  // The bytes of its table of chunks. Sides beyond kMaxSide are refused by what reads the window.
  Result<std::uint64_t> check_part(const Part& part) const {
    if (part.chunk_count > bytes_ / kTableEntryBytes) return too_many_chunks();
    PartShape shape = part.shape;
    if (shape.width < 1 || shape.height < 1 || shape.width > kMaxSide || shape.height > kMaxSide)
      return std::uint64_t{0};
    shape.tiled = shape.tile_width > 0 && is_tiled(part);
    // Of deep parts it is the table of counts that is as large as a chunk's window.
    if (part.type.starts_with("deep")) shape.pixel_bytes = 4;
    const double allowed = static_cast<double>(std::max(kPlainChunkBytes, kMaxExpansion * bytes_));
    if (chunk_bytes(shape) > allowed)
      return fail(ErrorCode::kDamage,
                  "{}: claims chunks of {:.0f} bytes in {} bytes: the file is cut or damaged",
                  name_, chunk_bytes(shape), bytes_);
    const std::uint64_t chunks = count_chunks(shape);
    if (chunks > bytes_ / kTableEntryBytes) return too_many_chunks();
    return std::max(chunks, part.chunk_count) * kTableEntryBytes;
  }

  // As OpenEXR decides: the version of a file of one part goes before its attribute.
  bool is_tiled(const Part& part) const {
    const bool by_version =
        (version_ & kMultiPart) == 0 && (part.type.empty() || (version_ & kNoImage) == 0);
    return by_version ? (version_ & kTiled) != 0
                      : part.type == "tiledimage" || part.type == "deeptile";
  }

  tl::unexpected<Error> refuse(const Attribute& attribute, std::string_view what) const {
    return fail(ErrorCode::kDamage, "{}: attribute {} {}: the EXR is cut or damaged", name_,
                printable_ascii(attribute.name), what);
  }
  tl::unexpected<Error> cut() const {
    return fail(ErrorCode::kDamage, "{}: the EXR is cut or damaged (its header ends at byte {})",
                name_, at_);
  }
  tl::unexpected<Error> too_many_chunks() const {
    return fail(ErrorCode::kDamage,
                "{}: claims more chunks than {} bytes can list: the EXR is cut or damaged", name_,
                bytes_);
  }

  std::string name_;
  std::ifstream file_;
  std::uint64_t bytes_;
  std::uint64_t at_ = 0;
  std::uint32_t version_ = 0;
};

}  // namespace

Result<std::uint64_t> scan_headers(const std::filesystem::path& path) {
  std::error_code status;
  const std::uintmax_t bytes = std::filesystem::file_size(path, status);
  if (status)
    return fail(ErrorCode::kIo, "{}: cannot be read ({})", path.string(), status.message());
  SPOOL_TRY(HeaderScan(path, bytes).run());
  return std::uint64_t{bytes};
}

}  // namespace spool::exr
