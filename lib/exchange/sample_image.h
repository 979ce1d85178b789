// One EXR image of a folder: one sample of every pixel, in the layers of a recording.
#pragma once

#include <cstddef>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/exchange/exr_names.h"

namespace spool::exchange {

struct SampleImage {
  std::vector<std::vector<std::byte>> layers;  // of the mapping, [y][x][c]
  ExrAttributes attributes;                    // of part 0
  std::set<std::string> lossy;                 // compressions of the layers that change values
};

// kData for sizes that are beyond those of a recording.
Result<void> check_size(const ExrWindow& window, const std::string& file);

// kData for an image that differs from `first` in parts, channels, window or colours, and for one
// of several samples; kDamage where it does not decode.
Result<SampleImage> read_sample_image(const std::filesystem::path& path,
                                      const std::vector<ExrPart>& first, const ExrMapping& mapping);

}  // namespace spool::exchange
