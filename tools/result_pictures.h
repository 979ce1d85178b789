// Pictures of one result beside its numbers: density, filter size, direction, squared error, and a
// contact sheet of them all.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "lib/core/image.h"
#include "lib/image_io/picture.h"
#include "lib/reconstruction/reconstructor.h"

namespace spool::tools {

// Mean over the channels of (image - reference)^2, [y][x].
Plane squared_error(const RgbImage& image, const RgbImage& reference);

// What the pictures of several results share, so that they can be compared by eye.
struct PictureScale {
  double exposure = 1.0;
  ValueRange density;
  std::optional<ValueRange> error;  // absent without a reference
};

// Error from the reference's mean luminance squared down to 1e-5 of it; density from 1 (or less,
// where pieces went without) to `largest_count`, logarithmic.
PictureScale picture_scale(const RgbImage* reference, const RgbImage& estimate,
                           double largest_count);

struct ResultImages {
  std::string title;
  const Reconstruction* reconstruction = nullptr;
  const CountImage* counts = nullptr;
  const RgbImage* reference = nullptr;  // may be null
};

// STEM.png: the contact sheet.
Result<void> write_contact_sheet(const std::filesystem::path& path, const ResultImages& images,
                                 const PictureScale& scale, bool overwrite);

// In `folder`: estimate.png, density.png and .exr, squared_error, filter_size, direction (the last
// three where there are such), each name ending in `suffix`.
Result<void> write_result_pictures(const std::filesystem::path& folder, const std::string& suffix,
                                   const ResultImages& images, const PictureScale& scale,
                                   bool overwrite);

}  // namespace spool::tools
