// Images of one result - estimate, density, filter size, direction, error maps - as numbers and as
// pictures, and a contact sheet of them all.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "lib/core/image.h"
#include "lib/filters/filter.h"
#include "lib/image_io/exr_types.h"
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
PictureScale picture_scale(const RgbImage* reference, const RgbImage& estimate,
                           double largest_count);

struct ResultImages {
  std::string title;
  const RgbImage* estimate = nullptr;
  const RgbImage* reference = nullptr;                         // may be null
  Plane density;                                               // samples of each piece
  std::optional<Plane> level, direction, squared_error, flip;  // absent: no picture of it
};

// What was made, with its squared error where there is a reference (else null).
ResultImages images_of(std::string title, const Reconstruction& made, const CountImage& counts,
                       const JudgingReference* reference);

// Adds the error maps that are absent, where there is a reference: the squared error, of which no
// variance of the reference is taken off, and FLIP of both images at the exposure.
void complete_maps(ResultImages& images, double exposure);

// All pictures of a result on one sheet.
Result<void> write_contact_sheet(const std::filesystem::path& path, const ResultImages& images,
                                 const PictureScale& scale, bool overwrite, bool shared = false);

// In `folder`: estimate, density, filter_size, direction, squared_error and flip, those that there
// are, as .exr to compute with; the estimate gets the attributes. kData names the first that cannot
// hold its numbers; the others are written.
Result<void> write_result_numbers(const std::filesystem::path& folder, const ResultImages& images,
                                  const ExrAttributes& attributes, const ExrWriteOptions& options);

// The same as .png to look at.
Result<void> write_result_pictures(const std::filesystem::path& folder, const ResultImages& images,
                                   const PictureScale& scale, bool overwrite, bool shared = false);

}  // namespace spool::tools
