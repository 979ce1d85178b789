#include "formats/interchange/sbmc_tile.h"

#include <array>
#include <bit>
#include <cmath>
#include <memory>

#include <lz4frame.h>

#include "formats/byte_io.h"
#include "formats/other_kinds.h"
#include "formats/record_layout.h"

namespace spool::interchange {
namespace {

using format::load;

constexpr size_t kHeaderBytes = 60;
// LZ4 cannot say more than this many bytes with one: what claims more lies, before memory is taken.
constexpr size_t kMaxLz4Expansion = 255;
constexpr int32_t kMaxTile = 1024;
enum Field : size_t {
  kVersion = 0,
  kTileSize = 4,
  kWidth = 8,
  kHeight = 12,
  kSamples = 16,
  kReferenceSamples = 20,
  kSampleFeatures = 24,
  kPixelFeatures = 28,
  kPathDepth = 32,
  kFocus = 36,
  kAperture = 40,
  kFov = 44,
  kRadius = 48,
  kTileX = 52,
  kTileY = 56
};

Result<void> check_fields(std::span<const std::byte> bytes, const std::string& name) {
  const auto field = [&](Field at) { return load<int32_t>(bytes, at); };
  const auto refuse = [&](Field at, std::string_view what) {
    return fail(ErrorCode::kData, "{}: {} is {} (byte {}): not a tile of SBMC", name, what,
                field(at), static_cast<size_t>(at));
  };
  if (field(kVersion) != 20181212 && field(kVersion) != 20190401)
    // Not the value: a list may name any file of the reader's, and an error line may be published.
    return fail(ErrorCode::kData, "{}: its version (byte {}) is none of SBMC: not a tile of SBMC",
                name, static_cast<size_t>(kVersion));
  if (field(kTileSize) < 1 || field(kTileSize) > kMaxTile) return refuse(kTileSize, "tile size");
  for (const Field side : {kWidth, kHeight})
    if (field(side) < 1 || static_cast<uint32_t>(field(side)) > format::kMaxSide ||
        field(side) % field(kTileSize) != 0)
      return refuse(side, "image size");
  if (static_cast<uint64_t>(field(kWidth)) * static_cast<uint64_t>(field(kHeight)) >
      format::kMaxPixels)
    return refuse(kHeight, "image height");
  if (field(kSamples) < 1 || static_cast<uint32_t>(field(kSamples)) > format::kMaxSpp)
    return refuse(kSamples, "sample count");
  if (field(kReferenceSamples) < 1) return refuse(kReferenceSamples, "samples of the reference");
  if (field(kSampleFeatures) != 27) return refuse(kSampleFeatures, "sample features");
  if (field(kPixelFeatures) != 30) return refuse(kPixelFeatures, "pixel features");
  if (field(kPathDepth) != 6) return refuse(kPathDepth, "path depth");
  for (const auto& [at, side] : {std::pair{kTileX, kWidth}, std::pair{kTileY, kHeight}})
    if (field(at) < 0 || field(at) >= field(side) || field(at) % field(kTileSize) != 0)
      return refuse(at, "place of the tile");
  return {};
}

// Decodes exactly one LZ4 frame [Lz4Frame] that is all of `stored` into all of `out`; kDamage
// otherwise. `name` opens the message: "FILE: tile frame 3".
Result<void> decode_lz4_frame(std::span<const std::byte> stored, std::span<std::byte> out,
                              std::string_view name) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)))
    return fail(ErrorCode::kIo, "{}: no memory for a decoder: free some", name);
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(
      raw, LZ4F_freeDecompressionContext);
  size_t taken = 0, given = 0, hint = 1;
  while (hint != 0) {
    size_t space = out.size() - given, left = stored.size() - taken;
    hint = LZ4F_decompress(context.get(), out.data() + given, &space, stored.data() + taken, &left,
                           nullptr);
    if (LZ4F_isError(hint))
      return fail(ErrorCode::kDamage, "{}: not an LZ4 frame ({}): fetch the file again", name,
                  LZ4F_getErrorName(hint));
    given += space;
    taken += left;
    if (hint != 0 && space == 0 && left == 0) break;  // requires more than there is, or more room
  }
  if (hint != 0 || given != out.size() || taken != stored.size())
    return fail(
        ErrorCode::kDamage,
        "{}: the frame gives {} of {} bytes and {} of its own are left: the file is damaged", name,
        given, out.size(), stored.size() - taken);
  return {};
}

}  // namespace

bool SbmcHeader::same_set(const SbmcHeader& other) const {
  const auto bits = [](float value) { return std::bit_cast<uint32_t>(value); };
  return version == other.version && tile_size == other.tile_size && width == other.width &&
         height == other.height && spp == other.spp && reference_spp == other.reference_spp &&
         bits(focus) == bits(other.focus) && bits(aperture) == bits(other.aperture) &&
         bits(fov) == bits(other.fov) && bits(radius) == bits(other.radius);
}

Result<SbmcTile> SbmcTile::open(const std::filesystem::path& path) {
  SbmcTile tile;
  const std::string name = path.string();
  SPOOL_ASSIGN(tile.file_, format::FileHandle::open(path, format::OpenMode::kRead));
  SPOOL_ASSIGN(tile.bytes_, tile.file_.size());
  if (tile.bytes_ < kHeaderBytes)
    return fail(ErrorCode::kDamage, "{}: {} bytes hold no header (byte 0): fetch the file again",
                name, tile.bytes_);
  std::array<std::byte, kHeaderBytes> bytes;
  SPOOL_TRY(tile.file_.read_at(0, bytes));
  SPOOL_TRY(format::refuse_other_kind(name, bytes, "a tile of SBMC", "give the folder of tiles"));
  SPOOL_TRY(check_fields(bytes, name));
  const auto field = [&](Field at) { return load<int32_t>(bytes, at); };
  SbmcHeader& header = tile.header_;
  const auto number = [&](Field at) { return load<float>(bytes, at); };
  header = {field(kVersion),
            static_cast<uint32_t>(field(kTileSize)),
            static_cast<uint32_t>(field(kWidth)),
            static_cast<uint32_t>(field(kHeight)),
            static_cast<uint32_t>(field(kSamples)),
            static_cast<uint32_t>(field(kReferenceSamples)),
            number(kFocus),
            number(kAperture),
            number(kFov),
            number(kRadius),
            static_cast<uint32_t>(field(kTileX)),
            static_cast<uint32_t>(field(kTileY))};
  // The focus distance means nothing to a pinhole and may be anything then.
  const bool camera = header.aperture >= 0 && std::isfinite(header.aperture) && header.fov >= 0 &&
                      std::isfinite(header.fov) && !std::isnan(header.radius) &&
                      std::isfinite(header.radius) && (header.aperture == 0 || header.focus >= 0);
  if (!camera)
    return fail(ErrorCode::kData,
                "{}: camera numbers {}, {}, {}, {} (byte 36) are impossible: not a tile of SBMC",
                name, header.focus, header.aperture, header.fov, header.radius);
  tile.at_ = kHeaderBytes;
  return tile;
}

Result<std::vector<std::byte>> SbmcTile::next_frame() {
  const std::string name =
      fmt::format("{}: frame {} (byte {})", file_.path().string(), frame_, at_);
  const uint64_t decoded = frame_ == 0 ? header_.image_frame_bytes() : header_.sample_frame_bytes();
  std::array<std::byte, 4> length;
  if (bytes_ - at_ < length.size())
    return fail(ErrorCode::kDamage, "{}: the file ends: fetch it again", name);
  SPOOL_TRY(file_.read_at(at_, length));
  const auto stored = load<int32_t>(length, 0);
  if (stored <= 0 || static_cast<uint64_t>(stored) > bytes_ - at_ - 4)
    return fail(ErrorCode::kDamage, "{}: claims {} bytes of {} left: the file is cut or damaged",
                name, stored, bytes_ - at_ - 4);
  if (decoded / kMaxLz4Expansion > static_cast<uint64_t>(stored))
    return fail(ErrorCode::kDamage, "{}: {} bytes cannot hold {}: the file is damaged", name,
                stored, decoded);
  std::vector<std::byte> packed(static_cast<size_t>(stored));
  SPOOL_TRY(file_.read_at(at_ + 4, packed));
  std::vector<std::byte> plain(static_cast<size_t>(decoded));
  SPOOL_TRY(decode_lz4_frame(packed, plain, name));
  at_ += 4 + static_cast<uint64_t>(stored);
  ++frame_;
  return plain;
}

Result<void> SbmcTile::finish() const {
  if (at_ == bytes_) return {};
  return fail(ErrorCode::kDamage,
              "{}: {} bytes follow the last frame (byte {}): the file is damaged",
              file_.path().string(), bytes_ - at_, at_);
}

}  // namespace spool::interchange
