#include "tools/methods/view_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lib/core/option_table.h"
#include "lib/image_io/picture.h"
#include "lib/image_io/png_writer.h"

namespace spool::tools {
namespace {

constexpr double kLogSpan = 30.0;
constexpr int kPictureSide = 512;  // small images are enlarged up to this

std::string_view family_of(std::string_view name) {
  return name.substr(0, name.find('.'));
}

bool has_view(const Views& views, std::string_view name) {
  return std::ranges::any_of(views.collected(),
                             [&](const View& view) { return view.name == name; });
}

void add_missing(Views& views, const std::string& name, const Plane& image) {
  if (!has_view(views, name)) views.add(name, image);
}

// Symmetric about 0, so that signs are seen, and up to what 99 % of the values reach: one bulb must
// not hide the rest.
ValueRange signed_range(const Plane& image) {
  std::vector<double> sizes;
  for (const double v : image.pixels()) {
    if (std::isfinite(v)) sizes.push_back(std::abs(v));
  }
  if (sizes.empty()) return {};
  std::ranges::sort(sizes);
  const double most = sizes[(sizes.size() - 1) * 99 / 100];
  const double limit = most > 0.0 ? most : sizes.back();
  return {-limit, limit, false};
}

ValueRange range_of(const Plane& image) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  bool positive = true;
  for (const double v : image.pixels()) {
    if (!std::isfinite(v)) continue;
    positive = positive && v >= 0.0;
    if (v > 0.0) low = std::min(low, v);
    high = std::max(high, v);
  }
  if (!positive) return signed_range(image);
  const std::array<const Plane*, 1> planes = {&image};
  return common_range(planes, high > kLogSpan * low);
}

Picture picture_of(const View& view) {
  const std::string_view family = family_of(view.name);
  if (family == "dominant_direction") return direction_picture(view.image);
  if (family == "level" || family == "stop") return category_picture(view.image);
  return false_colour(view.image, range_of(view.image));
}

}  // namespace

const std::vector<ViewDescription>& selection_views() {
  static const std::vector<ViewDescription> views = {
      {"n", "samples taken of each piece"},
      {"A.k", "attenuation that the sampler handed on, if it keeps one"}};
  return views;
}

const std::vector<ViewDescription>& image_views() {
  static const std::vector<ViewDescription> views = {
      {"level", "scale chosen for each piece, if the filter chooses one"},
      {"dominant_direction", "degrees; NaN where round; if the filter has one"},
      {"variance.c", "estimated variance of the output (R, G, B), if the filter has one"}};
  return views;
}

Result<void> check_views(const std::vector<std::string>& wanted,
                         const std::vector<ViewDescription>& known) {
  std::vector<std::string> families = {"all"};
  for (const ViewDescription& view : known)
    families.emplace_back(family_of(view.name));
  for (const std::string& name : wanted) {
    const std::string family(family_of(name));
    if (std::ranges::find(families, family) != families.end()) continue;
    return fail(ErrorCode::kUsage, "--views {}: no such view here{}: see spool list views", name,
                did_you_mean(family, families));
  }
  return {};
}

void add_selection_views(const Selection& selection, Views& views) {
  add_missing(views, "n", as_plane(selection.statistics.n));
  for (std::size_t k = 0; k < selection.attenuation.size(); ++k)
    add_missing(views, fmt::format("A.{}", k), selection.attenuation[k]);
}

void add_image_views(const Reconstruction& reconstruction, Views& views) {
  if (reconstruction.level) add_missing(views, "level", as_plane(*reconstruction.level));
  if (reconstruction.dominant_direction) {
    add_missing(views, "dominant_direction", *reconstruction.dominant_direction);
  }
  for (std::size_t c = 0; reconstruction.variance && c < 3; ++c)
    add_missing(views, std::string("variance.") + "RGB"[c], (*reconstruction.variance)[c]);
}

std::vector<std::string> add_view_layers(const Views& views, ExrFile& file) {
  std::vector<std::string> left_out;
  for (const View& view : views.collected()) {
    if (view.image.width() == file.width && view.image.height() == file.height) {
      file.channels.push_back({"view." + view.name, PixelType::kFloat, view.image});
    } else {
      left_out.push_back(view.name);
    }
  }
  return left_out;
}

Result<void> write_view_pictures(const Views& views, const std::filesystem::path& folder,
                                 bool overwrite) {
  std::error_code status;
  std::filesystem::create_directories(folder, status);
  for (const View& view : views.collected()) {
    const int side = std::max(view.image.width(), view.image.height());
    const int factor = std::max(1, kPictureSide / std::max(side, 1));
    SPOOL_TRY(
        write_png(folder / (view.name + ".png"), enlarge(picture_of(view), factor), overwrite));
  }
  return {};
}

}  // namespace spool::tools
