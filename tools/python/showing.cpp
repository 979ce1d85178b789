#include "tools/python/showing.h"

#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <tuple>
#include <utility>

#include <nlohmann/json.hpp>

#include "lib/image_io/atomic_file.h"
#include "lib/image_io/contact_sheet.h"
#include "lib/image_io/foreign_picture.h"
#include "lib/image_io/png_writer.h"
#include "tools/json/json_text.h"
#include "tools/python/arrays.h"
#include "tools/python/running.h"
#include "tools/show/shown_images.h"
#include "tools/verbs/info.h"

namespace spool::python {
namespace {

using Png = std::vector<unsigned char>;

// Name of the image or sampler, filter, budget, image, and of a replay counts, level and direction.
using ShownArrays =
    std::tuple<std::string, std::string, double, ImageArray, std::optional<CountArray>,
               std::optional<PlaneArray>, std::optional<PlaneArray>>;
using Crop = std::tuple<int, int, int, int>;

std::optional<CountImage> counts_of(const std::optional<CountArray>& array,
                                    const std::string& name) {
  if (!array) return std::nullopt;
  Result<CountImage> counts = counts_from_numpy(*array, name);
  if (!counts) raise(counts.error());
  return std::move(*counts);
}

tools::ShownImage shown_of(const ShownArrays& arrays) {
  const auto& [name, filter, spp, image, counts, level, direction] = arrays;
  tools::ShownImage shown{name, {}, filter, spp, counts_of(counts, name)};
  shown.result.image = rgb_from_numpy(image);
  if (level) {
    const Plane values = plane_from_numpy(*level);
    shown.result.level = CountImage(values.width(), values.height());
    std::ranges::copy(values.pixels(), shown.result.level->pixels().begin());
  }
  if (direction) shown.result.dominant_direction = plane_from_numpy(*direction);
  return shown;
}

nb::bytes bytes_of(const auto& text) {
  return nb::bytes(static_cast<const void*>(text.data()), text.size());
}

nb::bytes shown(const std::vector<ShownArrays>& arrays, const std::optional<ImageArray>& reference,
                const std::string& title, const std::vector<Crop>& crops,
                const std::optional<double>& exposure, double most_mb) {
  std::vector<tools::ShownImage> images;
  for (const ShownArrays& one : arrays)
    images.push_back(shown_of(one));
  std::optional<RgbImage> judge;
  if (reference) judge = rgb_from_numpy(*reference);
  tools::ShowSettings settings{title, {}, exposure, most_mb};
  for (const auto& [x, y, width, height] : crops)
    settings.crops.push_back({x, y, width, height});
  return bytes_of(run<std::string>(
      [&](Watch&) { return tools::shown_planes(images, judge, settings); }, nb::none(), 0));
}

nb::bytes png_of(const Picture& picture) {
  return bytes_of(run<Png>([&](Watch&) { return png_bytes(picture); }, nb::none(), 0));
}

Plane shrunk_to(const Plane& plane, int most_side) {
  const int longer = std::max(plane.width(), plane.height());
  return tools::shrunk(plane, std::max(1, (longer + most_side - 1) / most_side));
}

// The exposure is that of the whole image.
nb::bytes tone_mapped_png(const ImageArray& array, const std::optional<double>& exposure,
                          int most_side) {
  RgbImage image = rgb_from_numpy(array);
  const double factor = exposure ? std::exp2(*exposure) : tone_exposure(image);
  for (Plane& plane : image)
    plane = shrunk_to(plane, most_side);
  return png_of(tone_map(image, factor));
}

// As the density of an evaluation's pictures, with its bar.
nb::bytes density_png(const CountArray& array, int most_side) {
  Plane plane = as_plane(*counts_of(array, "counts"));
  const ValueRange range{1.0, std::max(2.0, *std::ranges::max_element(plane.pixels())), true};
  plane = shrunk_to(plane, most_side);
  return png_of(labelled_picture(
      {"density", false_colour(plane, range), ColourBar{range, "samples per piece"}}));
}

std::string statistics_json(const ImageArray& array) {
  return tools::json_text(tools::image_statistics(rgb_from_numpy(array)));
}

using Rows = std::vector<std::vector<std::string>>;

// Texts of a file may be no UTF-8.
std::string facts_json(const std::filesystem::path& path) {
  return tools::json_text(
      run<Rows>([&](Watch&) { return tools::recording_facts(path); }, nb::none(), 0));
}

// Where the pixels of a file lie: x0, y0, width, height, of what is held and of its display.
using Windows = std::array<std::int64_t, 8>;

Windows windows_of(const ForeignPicture& picture) {
  const ExrWindow &a = picture.shown, &b = picture.display;
  return {a.x0, a.y0, a.width, a.height, b.x0, b.y0, b.width, b.height};
}

// The image; what was chosen, converted or left out: one line, or ""; where its pixels lie.
std::tuple<nb::object, std::string, Windows> read_image(const std::string& path) {
  const auto picture = run<ForeignPicture>(
      [&](Watch&) { return read_picture(path, kNoLayerOption); }, nb::none(), 0);
  return {rgb_to_numpy(picture.rgb), remark_line(path, picture.remarks), windows_of(picture)};
}

// Raises where a file of the first one's size lies elsewhere.
void check_windows(const std::vector<std::tuple<std::string, Windows>>& files) {
  const auto placed = [](const Windows& w) {
    ForeignPicture picture;
    picture.shown = {w[0], w[1], w[2], w[3]};
    picture.display = {w[4], w[5], w[6], w[7]};
    return picture;
  };
  for (const auto& [path, windows] : files) {
    const auto& [first, other] = files.front();
    if (windows[2] != other[2] || windows[3] != other[3]) continue;
    if (const auto checked = check_aligned(placed(windows), placed(other), path, first); !checked)
      raise(checked.error());
  }
}

void write_text(const std::string& path, const std::string& text, bool force) {
  run_watched([&](Watch&) { return write_text_file(path, text, force); }, nb::none(), 0);
}

}  // namespace

void bind_showing(nb::module_& module) {
  module.def("shown", &shown, nb::arg("images"), nb::arg("reference").none(), nb::arg("title"),
             nb::arg("crops"), nb::arg("exposure").none(), nb::arg("most_mb"));
  module.def("tone_mapped_png", &tone_mapped_png, nb::arg("image"), nb::arg("exposure").none(),
             nb::arg("most_side"));
  module.def("density_png", &density_png, nb::arg("counts"), nb::arg("most_side"));
  module.def("image_statistics", &statistics_json, nb::arg("image"));
  module.def("recording_facts", &facts_json, nb::arg("path"));
  module.def("read_image", &read_image, nb::arg("path"));
  module.def("check_windows", &check_windows, nb::arg("files"));
  module.def("write_text", &write_text, nb::arg("path"), nb::arg("text"), nb::arg("force"));
}

}  // namespace spool::python
