// OpenEXR images as planes of doubles: flat files, half, float and 32-bit unsigned channels.
//
// Values are scene-linear and unchanged: every half, float and uint is held exactly by a double.
// Channel names may carry a layer, "A.0"; they come back in alphabetical order. The size is that of
// the data window. Files are taken as hostile: sizes are checked against the cap and against the
// length of the file before anything is allocated.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/image.h"
#include "lib/image_io/exr_source.h"
#include "lib/image_io/exr_types.h"

namespace spool {

struct NamedPlane {
  std::string name;
  PixelType type = PixelType::kFloat;
  Plane data;  // [y][x]
};

struct ExrFile {
  int width = 0;
  int height = 0;
  std::vector<NamedPlane> channels;
  std::map<std::string, std::string> text_attributes = {};
  std::map<std::string, double> number_attributes = {};

  const Plane* find(std::string_view name) const;  // nullptr when absent
};

// A file of this program: one part, all of its channels; foreign_picture.h reads those of others.
// kIo when the file cannot be opened, kData when it is no flat EXR or too large, kDamage when
// pixels are missing or do not decode.
Result<ExrFile> read_exr(const std::filesystem::path& path, const ExrReadLimits& limits = {});

// All channels of a part.
Result<ExrFile> read_part(ExrSource& source, std::size_t part);

// Writes compressed scanlines under a temporary name, then renames. A value that the channel's
// type cannot hold (a half above 65504, a negative or fractional count) is an error with its pixel.
Result<void> write_exr(const std::filesystem::path& path, const ExrFile& image,
                       const ExrWriteOptions& options = {});
// The same; gives back the memory of the image on the way.
Result<void> write_exr(const std::filesystem::path& path, ExrFile&& image,
                       const ExrWriteOptions& options = {});

// An image whose channels are R, G, B (float).
ExrFile exr_from_rgb(RgbImage rgb);
ExrFile exr_from_plane(std::string channel, Plane plane, PixelType type = PixelType::kFloat);

// Every half, float and uint is a double, exactly.
Plane to_doubles(const ExrPlane& plane, int width, int height);

}  // namespace spool
