// Pictures of one result beside its numbers: density, filter size, direction, squared error, and a
// contact sheet of them all.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "lib/core/image.h"
#include "lib/filters/filter.h"
#include "lib/image_io/picture.h"
#include "lib/metrics/error_metrics.h"

namespace spool::tools {

// What the pictures of several results share, so that they can be compared by eye.
struct PictureScale {
  double exposure = 1.0;
  ValueRange density;
  std::optional<ValueRange> error;  // absent without a reference
};

// Error from the reference's mean luminance squared down to 1e-5 of it; density from 1 (or less,
// where pieces went without) to `largest_count`, logarithmic.
PictureScale picture_scale(const JudgingReference* reference, const RgbImage& estimate,
                           double largest_count);

struct ResultImages {
  std::string title;
  const Reconstruction* reconstruction = nullptr;
  const CountImage* counts = nullptr;
  const JudgingReference* reference = nullptr;  // may be null
};

// All pictures of a result on one sheet.
Result<void> write_contact_sheet(const std::filesystem::path& path, const ResultImages& images,
                                 const PictureScale& scale, bool overwrite, bool shared = false);

// In `folder`: estimate, density, filter_size, direction, squared_error and flip (the last four
// where there are such; FLIP of both images at the scale's exposure), each as .png to look at and
// .exr to compute with. kData names the first that cannot hold its numbers; the others are written.
Result<void> write_result_pictures(const std::filesystem::path& folder, const ResultImages& images,
                                   const PictureScale& scale, bool overwrite, bool shared = false);

}  // namespace spool::tools
