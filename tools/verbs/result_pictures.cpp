#include "tools/verbs/result_pictures.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "lib/image_io/contact_sheet.h"
#include "lib/image_io/exr_image.h"
#include "lib/image_io/png_writer.h"
#include "lib/metrics/flip.h"

namespace spool::tools {
namespace {

struct NamedPanel {
  std::string name;
  Panel panel;
};

NamedPanel size_panel(const Plane& level) {
  std::set<int> used;
  for (const double value : level.pixels()) {
    if (std::abs(value) < 1e6) used.insert(static_cast<int>(value));
  }
  CategoryKey key;
  for (const int l : used) {
    key.entries.emplace_back(l <= 0 ? "none" : std::to_string(1 << std::min(l, 30)),
                             l < 0 ? kNeutral : category_colour(l));
  }
  return {"filter_size", {"filter size (pixels)", category_picture(level), std::move(key)}};
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

std::vector<NamedPanel> panels_of(const ResultImages& images, const PictureScale& scale) {
  std::vector<NamedPanel> panels;
  panels.push_back({"estimate", {"estimate", tone_map(*images.estimate, scale.exposure), {}}});
  if (images.reference) {
    panels.push_back({"reference", {"reference", tone_map(*images.reference, scale.exposure), {}}});
  }
  panels.push_back({"density",
                    {"density", false_colour(images.density, scale.density),
                     ColourBar{scale.density, "samples per piece"}}});
  if (images.level) panels.push_back(size_panel(*images.level));
  if (images.direction) {
    panels.push_back(
        {"direction",
         {"direction (degrees)", direction_picture(*images.direction), DirectionKey{}}});
  }
  if (images.squared_error && scale.error) {
    panels.push_back({"squared_error",
                      {"squared error", false_colour(*images.squared_error, *scale.error),
                       ColourBar{*scale.error, "mean over channels"}}});
  }
  return panels;
}

NamedPanel flip_panel(const Plane& flip) {
  const ValueRange range{0.0, 1.0, false};
  return {"flip", {"FLIP", false_colour(flip, range), ColourBar{range, "FLIP difference"}}};
}

}  // namespace

PictureScale picture_scale(const RgbImage* reference, const RgbImage& estimate,
                           double largest_count) {
  const RgbImage& guide = reference ? *reference : estimate;
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

ResultImages images_of(std::string title, const Reconstruction& made, const CountImage& counts,
                       const JudgingReference* reference) {
  ResultImages images{std::move(title), &made.image, nullptr, as_plane(counts), {}, {}, {}, {}};
  if (made.level) images.level = as_plane(*made.level);
  images.direction = made.dominant_direction;
  if (!reference) return images;
  images.reference = &reference->mean;
  images.squared_error = squared_error_map(made.image, *reference);
  return images;
}

void complete_maps(ResultImages& images, double exposure) {
  if (!images.reference) return;
  if (!images.squared_error)
    images.squared_error = squared_error_map(*images.estimate, {*images.reference, {}, {}});
  if (!images.flip) {
    images.flip =
        flip_ldr_map(exposed(*images.reference, exposure), exposed(*images.estimate, exposure));
  }
}

Result<void> write_contact_sheet(const std::filesystem::path& path, const ResultImages& images,
                                 const PictureScale& scale, bool overwrite, bool shared) {
  std::vector<Panel> panels;
  for (NamedPanel& named : panels_of(images, scale))
    panels.push_back(std::move(named.panel));
  return write_png(path, contact_sheet(images.title, panels), overwrite, shared);
}

Result<void> write_result_numbers(const std::filesystem::path& folder, const ResultImages& images,
                                  const ExrAttributes& attributes, const ExrWriteOptions& options) {
  Result<void> all;
  const auto write = [&](const char* name, const ExrFile& file,
                         ExrCompression compression) -> Result<void> {
    ExrWriteOptions of_file = options;
    of_file.compression = compression;
    const Result<void> written = write_exr(folder / (std::string(name) + ".exr"), file, of_file);
    if (!written && written.error().code != ErrorCode::kData) return written;
    if (!written && all) all = written;
    return {};
  };
  // Zip takes three times as long, and saves 2 % of noisy floats.
  const auto write_floats = [&](const char* name, const char* channel,
                                const std::optional<Plane>& plane) -> Result<void> {
    if (!plane) return {};
    return write(name, exr_from_plane(channel, *plane), ExrCompression::kNone);
  };
  ExrFile estimate = exr_from_rgb(*images.estimate);
  estimate.text_attributes = attributes.texts;
  estimate.number_attributes = attributes.numbers;
  SPOOL_TRY(write("estimate", estimate, ExrCompression::kNone));
  SPOOL_TRY(write("density", exr_from_plane("n", images.density, PixelType::kUint),
                  ExrCompression::kZip));
  if (images.level) {
    SPOOL_TRY(write("filter_size", exr_from_plane("level", *images.level), ExrCompression::kZip));
  }
  SPOOL_TRY(write_floats("direction", "angle", images.direction));
  SPOOL_TRY(write_floats("squared_error", "Y", images.squared_error));
  SPOOL_TRY(write_floats("flip", "flip", images.flip));
  return all;
}

Result<void> write_result_pictures(const std::filesystem::path& folder, const ResultImages& images,
                                   const PictureScale& scale, bool overwrite, bool shared) {
  std::vector<NamedPanel> panels = panels_of(images, scale);
  if (images.flip) panels.push_back(flip_panel(*images.flip));
  for (const NamedPanel& named : panels) {
    if (named.name == "reference") continue;  // the same for every result
    SPOOL_TRY(write_png(folder / (named.name + ".png"), labelled_picture(named.panel), overwrite,
                        shared));
  }
  return {};
}

}  // namespace spool::tools
