// One tile file of an SBMC set: header and frames, checked (sbmc.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "formats/file_handle.h"
#include "lib/core/error.h"

namespace spool::interchange {

// Planes of a sample frame.
namespace sbmc_plane {
inline constexpr uint32_t kFilm = 0, kLens = 2, kTime = 4, kDiffuse = 5, kSpecular = 8;
inline constexpr uint32_t kNormalFirst = 11, kNormal = 14, kDepthFirst = 17, kDepth = 18;
inline constexpr uint32_t kVisibility = 19, kHit = 20, kAlbedoFirst = 21, kAlbedo = 24;
inline constexpr uint32_t kPdf = 27, kPdfCount = 24, kAngles = 51, kFlags = 63, kVertices = 6;
inline constexpr uint32_t kImagePlanes = 30, kImageSpecular = 3, kImageVariances = 15;
}  // namespace sbmc_plane

struct SbmcHeader {
  int32_t version = 0;
  uint32_t tile_size = 0, width = 0, height = 0, spp = 0, reference_spp = 0;
  float focus = 0, aperture = 0, fov = 0, radius = 0;
  uint32_t x = 0, y = 0;  // of the tile

  uint64_t pixels() const { return uint64_t{tile_size} * tile_size; }
  uint64_t image_frame_bytes() const { return sbmc_plane::kImagePlanes * 4 * pixels(); }
  uint64_t sample_frame_bytes() const {
    return (sbmc_plane::kFlags * 4 + sbmc_plane::kVertices * 2) * pixels();
  }
  // All but the place.
  bool same_set(const SbmcHeader& other) const;
};

class SbmcTile {
 public:
  static Result<SbmcTile> open(const std::filesystem::path& path);

  const SbmcHeader& header() const { return header_; }
  const format::FileHandle& file() const { return file_; }
  // The next frame, in file order: the reference planes, then one per sample.
  Result<std::vector<std::byte>> next_frame();
  // After the last frame: nothing may follow.
  Result<void> finish() const;

 private:
  format::FileHandle file_;
  SbmcHeader header_;
  uint64_t bytes_ = 0;
  uint64_t at_ = 0;
  uint32_t frame_ = 0;
};

}  // namespace spool::interchange
