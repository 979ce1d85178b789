// Images beside each other, with or without a recording: what the page of `spool show` is made of.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "lib/core/error.h"
#include "lib/core/image.h"
#include "lib/filters/filter.h"

namespace spool::tools {

struct ShownImage {
  std::string name;
  Reconstruction result;                  // the image, and what else a filter has
  std::string filter = {};                // of a replay: `name` is then that of its sampler
  double spp = 0.0;                       // of a replay
  std::optional<CountImage> counts = {};  // of a replay
};

struct ShownCrop {
  int x = 0, y = 0, width = 0, height = 0;
};

struct ShowSettings {
  std::string title = {};
  std::vector<ShownCrop> crops = {};  // none: where images differ most
  std::optional<double> exposure;     // EV; absent: tone_exposure of the reference or first image
  double most_mb = 40.0;              // of images in the page; larger ones are shrunk
};

inline constexpr std::size_t kMostShown = 64;  // images of a page

// Of the values: mean luminance, smallest and largest value over finite pixels, how many are not.
// With a reference mse, relmse and flip_ldr, of which none is known where pixels are not finite.
nlohmann::ordered_json image_statistics(const RgbImage& image, const RgbImage* reference = nullptr);

// The means of `factor` x `factor` values; at the right and lower edge of those that there are.
Plane shrunk(const Plane& plane, int factor);

Result<void> validate(const ShowSettings& settings);

// What tools/report/show_page.py reads: plane_text.h with the pictures of each image, its error and
// FLIP against the reference at the exposure of all, and the numbers. Maps and numbers are made
// before anything is shrunk. kUsage for images of different sizes, too many, crops outside.
Result<std::string> shown_planes(const std::vector<ShownImage>& images,
                                 const std::optional<RgbImage>& reference,
                                 const ShowSettings& settings);

}  // namespace spool::tools
