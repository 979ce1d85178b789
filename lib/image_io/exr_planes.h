// Flat OpenEXR files bit for bit: channels in their own type, every part.
//
// exr_image.h is for pictures; this is for exchange, where a NaN keeps its payload and a half stays
// a half. deep_exr_file.h has deep scanlines. Files are taken as hostile: sizes are checked against
// the cap and against the length of the file before anything is allocated. Errors as in
// exr_image.h.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/image_io/exr_types.h"

namespace spool {

struct ExrPlane {
  std::string name;
  PixelType type = PixelType::kFloat;
  std::vector<std::byte> values = {};  // [y][x], little-endian
};

struct ExrPlanes {
  int width = 0;
  int height = 0;
  int x0 = 0, y0 = 0;  // of the data window
  std::vector<ExrPlane> planes = {};
  ExrAttributes attributes = {};
  bool rec709 = true;  // no chromaticities, or those of Rec. 709
};

// The first limits.max_parts parts. Where a later part is named and its channels are not, "PART."
// is put before them, as readers of several parts do. Parts of another size are refused (kData).
Result<ExrPlanes> read_exr_planes(const std::filesystem::path& path,
                                  const ExrReadLimits& limits = {});

// One part, compressed scanlines; written under a temporary name, then renamed.
Result<void> write_exr_planes(const std::filesystem::path& path, const ExrPlanes& image,
                              const ExrWriteOptions& options = {});

}  // namespace spool
