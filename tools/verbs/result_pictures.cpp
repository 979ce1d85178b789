#include "tools/verbs/result_pictures.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "lib/core/as_plane.h"
#include "lib/image_io/contact_sheet.h"
#include "lib/image_io/exr_image.h"
#include "lib/image_io/png_writer.h"
#include "lib/metrics/flip.h"

namespace spool::tools {
namespace {

// One picture and the numbers it shows.
struct NamedPanel {
  std::string name;
  Panel panel;
  ExrFile data;
};

ExrFile one_channel(const char* name, PixelType type, const Plane& plane) {
  ExrFile file;
  file.width = plane.width();
  file.height = plane.height();
  file.channels.push_back({name, type, plane});
  return file;
}

NamedPanel size_panel(const CountImage& level) {
  std::set<int> used(level.pixels().begin(), level.pixels().end());
  CategoryKey key;
  for (const int l : used) {
    key.entries.emplace_back(l <= 0 ? "none" : std::to_string(1 << std::min(l, 30)),
                             l < 0 ? kNeutral : category_colour(l));
  }
  const Plane plane = as_plane(level);
  return {"filter_size",
          {"filter size (pixels)", category_picture(plane), std::move(key)},
          one_channel("level", PixelType::kFloat, plane)};
}

// Pixels that are not finite are black: FLIP has no value for them, and one would spread.
RgbImage exposed(const RgbImage& image, double exposure) {
  RgbImage result = image;
  for (Plane& plane : result) {
    for (std::size_t i = 0; i < plane.size(); ++i)
      plane[i] = std::isfinite(plane[i]) ? exposure * plane[i] : 0.0;
  }
  return result;
}

std::vector<NamedPanel> panels_of(const ResultImages& images, const PictureScale& scale,
                                  bool with_flip) {
  const Reconstruction& result = *images.reconstruction;
  std::vector<NamedPanel> panels;
  panels.push_back({"estimate",
                    {"estimate", tone_map(result.image, scale.exposure), {}},
                    exr_from_rgb(result.image)});
  if (images.reference) {
    panels.push_back(
        {"reference", {"reference", tone_map(images.reference->mean, scale.exposure), {}}, {}});
  }
  const Plane density = as_plane(*images.counts);
  panels.push_back({"density",
                    {"density", false_colour(density, scale.density),
                     ColourBar{scale.density, "samples per piece"}},
                    one_channel("n", PixelType::kUint, density)});
  if (result.level) panels.push_back(size_panel(*result.level));
  if (result.dominant_direction) {
    panels.push_back(
        {"direction",
         {"direction (degrees)", direction_picture(*result.dominant_direction), DirectionKey{}},
         one_channel("angle", PixelType::kFloat, *result.dominant_direction)});
  }
  if (images.reference && scale.error) {
    const Plane error = squared_error_map(result.image, *images.reference);
    panels.push_back({"squared_error",
                      {"squared error", false_colour(error, *scale.error),
                       ColourBar{*scale.error, "mean over channels"}},
                      one_channel("Y", PixelType::kFloat, error)});
  }
  if (images.reference && with_flip) {
    const Plane flip = flip_ldr_map(exposed(images.reference->mean, scale.exposure),
                                    exposed(result.image, scale.exposure));
    const ValueRange range{0.0, 1.0, false};
    panels.push_back({"flip",
                      {"FLIP", false_colour(flip, range), ColourBar{range, "FLIP difference"}},
                      one_channel("flip", PixelType::kFloat, flip)});
  }
  return panels;
}

}  // namespace

PictureScale picture_scale(const JudgingReference* reference, const RgbImage& estimate,
                           double largest_count) {
  const RgbImage& guide = reference ? reference->mean : estimate;
  PictureScale scale;
  scale.exposure = tone_exposure(guide);
  scale.density = {1.0, std::max(2.0, largest_count), true};
  if (!reference) return scale;
  double sum = 0.0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < guide[0].size(); ++i) {
    const double y = luminance(guide[0][i], guide[1][i], guide[2][i]);
    if (!std::isfinite(y)) continue;
    sum += y;
    ++n;
  }
  const double mean = n > 0 ? sum / static_cast<double>(n) : 0.0;
  const double high = mean > 0.0 ? mean * mean : 1.0;
  scale.error = ValueRange{1e-5 * high, high, true};
  return scale;
}

Result<void> write_contact_sheet(const std::filesystem::path& path, const ResultImages& images,
                                 const PictureScale& scale, bool overwrite, bool shared) {
  std::vector<Panel> panels;
  for (NamedPanel& named : panels_of(images, scale, false))
    panels.push_back(std::move(named.panel));
  return write_png(path, contact_sheet(images.title, panels), overwrite, shared);
}

Result<void> write_result_pictures(const std::filesystem::path& folder, const ResultImages& images,
                                   const PictureScale& scale, bool overwrite, bool shared) {
  Result<void> all;
  for (const NamedPanel& named : panels_of(images, scale, true)) {
    const std::filesystem::path stem = folder / named.name;
    if (named.name == "reference") continue;  // the same for every result
    SPOOL_TRY(write_png(stem.string() + ".png", labelled_picture(named.panel), overwrite, shared));
    const Result<void> written =
        write_exr(stem.string() + ".exr", named.data, {.overwrite = overwrite, .shared = shared});
    if (!written && written.error().code != ErrorCode::kData) return written;
    if (!written && all) all = written;
  }
  return all;
}

}  // namespace spool::tools
