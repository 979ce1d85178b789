// Flat OpenEXR files of one part, bit for bit: channels in their own type.
//
// exr_image.h has pictures as doubles, exr_source.h files of other programs. Errors as there.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/image_io/exr_types.h"

namespace spool {

struct ExrPlanes {
  int width = 0;
  int height = 0;
  std::vector<ExrPlane> planes = {};
  ExrAttributes attributes = {};
  std::string lossy = {};  // as of ExrPart
};

// kData for a file of several parts.
Result<ExrPlanes> read_exr_planes(const std::filesystem::path& path,
                                  const ExrReadLimits& limits = {});

// One part, compressed scanlines; written under a temporary name, then renamed.
Result<void> write_exr_planes(const std::filesystem::path& path, const ExrPlanes& image,
                              const ExrWriteOptions& options = {});

}  // namespace spool
