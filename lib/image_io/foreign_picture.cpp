#include "lib/image_io/foreign_picture.h"

#include <algorithm>
#include <cmath>

#include <fmt/ranges.h>

#include "lib/core/counted.h"
#include "lib/image_io/colour_space.h"
#include "lib/image_io/exr_image.h"

namespace spool {
namespace {

constexpr std::size_t kToldNames = 8;  // more than listed() shows need no care

ExrWindow shared(const ExrWindow& a, const ExrWindow& b) {
  const std::int64_t x0 = std::max(a.x0, b.x0), y0 = std::max(a.y0, b.y0);
  return {x0, y0, std::min(a.x0 + a.width, b.x0 + b.width) - x0,
          std::min(a.y0 + a.height, b.y0 + b.height) - y0};
}

Plane cropped(Plane plane, const ExrWindow& from, const ExrWindow& to) {
  if (from == to) return plane;
  Plane result(static_cast<int>(to.width), static_cast<int>(to.height));
  for (int y = 0; y < result.height(); ++y)
    for (int x = 0; x < result.width(); ++x)
      result(x, y) =
          plane(x + static_cast<int>(to.x0 - from.x0), y + static_cast<int>(to.y0 - from.y0));
  return result;
}

void convert(const ColourMatrix& matrix, RgbImage& rgb) {
  for (std::size_t i = 0; i < rgb[0].size(); ++i) {
    const std::array<double, 3> from = {rgb[0][i], rgb[1][i], rgb[2][i]};
    for (std::size_t c = 0; c < 3; ++c)
      rgb[c][i] = matrix[c][0] * from[0] + matrix[c][1] * from[1] + matrix[c][2] * from[2];
  }
}

// Of three colours or one grey, the channels in the order R, G, B.
std::vector<std::size_t> channels_of(const ExrLayer& layer) {
  if (layer.colour) return {layer.colour->begin(), layer.colour->end()};
  return {*layer.grey};
}

enum class Pixels { kAll, kNone };

Result<ExrWindow> shown_window(const std::string& name, const ExrPart& part) {
  const ExrWindow shown = shared(part.data, part.display);
  if (shown.width >= 1 && shown.height >= 1) return shown;
  return fail(ErrorCode::kData,
              "{}: the data window ({}) lies outside of the display window ({}): nothing is "
              "shown; move it, e.g. oiiotool --origin",
              name, text_of(part.data), text_of(part.display));
}

Result<ForeignPicture> read_layer(ExrSource& source, const std::vector<ExrLayer>& layers,
                                  const ChosenLayer& chosen, bool any_number,
                                  const std::optional<NeededSize>& needed, Pixels pixels) {
  const ExrLayer& layer = chosen.layer;
  const ExrPart& part = source.parts()[layer.part];
  const std::vector<std::size_t> channels = channels_of(layer);
  ForeignPicture picture;
  picture.display = part.display;
  SPOOL_ASSIGN(picture.shown, shown_window(source.name(), part));
  if (!chosen.remark.empty()) picture.remarks.push_back(chosen.remark);
  if (needed) SPOOL_TRY(check_size(source.name(), picture.shown, *needed));
  for (const std::size_t c : channels)
    if (part.channels[c].type == PixelType::kUint && !any_number)
      return fail(ErrorCode::kData,
                  "{}: channel {} holds whole numbers (uint), a picture has half or float: divide "
                  "by the largest and linearise",
                  source.name(), part.channels[c].name);
  std::optional<ColourConversion> conversion;
  if (layer.colour || !any_number) {
    SPOOL_ASSIGN(conversion, conversion_to_rec709(part, source.name()));
  }
  std::vector<ExrPlane> planes;
  if (pixels == Pixels::kAll) {
    SPOOL_ASSIGN(planes, source.read(layer.part, channels));
  }
  const int width = static_cast<int>(part.data.width), height = static_cast<int>(part.data.height);
  for (std::size_t c = 0; c < planes.size(); ++c) {
    picture.rgb[c] = cropped(to_doubles(planes[c], width, height), part.data, picture.shown);
    planes[c].values = {};
  }
  if (layer.grey) {
    picture.rgb[1] = picture.rgb[2] = picture.rgb[0];
    picture.channel = part.channels[*layer.grey].name;
  }
  if (conversion && layer.colour) {
    convert(conversion->matrix, picture.rgb);
    picture.converted_from = conversion->from;
    picture.remarks.push_back(fmt::format("converted from {} to Rec. 709", conversion->from));
  }
  if (layer.grey && picture.channel != "Y")
    picture.remarks.push_back(picture.channel + " is taken as grey");
  if (!part.lossy.empty())
    picture.remarks.push_back(
        part.lossy + " is a compression with loss: the values are near those that were saved");
  if (picture.shown != part.data)
    picture.remarks.push_back(fmt::format("pixels outside of the display window ({}) are left out",
                                          text_of(part.display)));
  std::vector<std::pair<std::size_t, std::size_t>> used;
  for (const std::size_t c : channels)
    used.emplace_back(layer.part, c);
  if (const std::string unused = unused_channels(source.parts(), layers, used); !unused.empty())
    picture.remarks.push_back("not used: " + unused);
  return picture;
}

Result<ForeignPicture> read(const std::filesystem::path& path, const LayerChoice& choice,
                            bool single, const std::optional<NeededSize>& needed,
                            Pixels pixels = Pixels::kAll) {
  SPOOL_ASSIGN(ExrSource source, ExrSource::open(path));
  const std::vector<ExrLayer> layers = layers_of(source.parts());
  const std::vector<ExrPart>& parts = source.parts();
  if (single && parts.size() == 1 && parts[0].channels.size() == 1 && parts[0].flat &&
      choice.layer.empty()) {
    ChosenLayer only{layers.at(0), ""};
    only.layer.grey = 0;
    SPOOL_ASSIGN(ForeignPicture picture, read_layer(source, layers, only, true, needed, pixels));
    picture.remarks.clear();
    return picture;
  }
  SPOOL_ASSIGN(const ChosenLayer chosen,
               choose_layer(source.name(), parts, layers, choice, Taken::kPicture));
  return read_layer(source, layers, chosen, single || !choice.layer.empty(), needed, pixels);
}

}  // namespace

Result<ForeignPicture> read_picture(const std::filesystem::path& path, const LayerChoice& choice,
                                    const std::optional<NeededSize>& needed) {
  return read(path, choice, false, needed);
}

Result<ForeignPicture> read_single_or_picture(const std::filesystem::path& path,
                                              const LayerChoice& choice,
                                              const std::optional<NeededSize>& needed) {
  return read(path, choice, true, needed);
}

Result<ForeignPicture> read_picture_header(const std::filesystem::path& path,
                                           const LayerChoice& choice) {
  return read(path, choice, false, {}, Pixels::kNone);
}

Result<void> check_size(const std::string& name, const ExrWindow& window,
                        const NeededSize& needed) {
  if (window.width == needed.width && window.height == needed.height) return {};
  return fail(ErrorCode::kData, "{}: is {} x {} pixels, {} {} x {}: make it as large", name,
              window.width, window.height, needed.of, needed.width, needed.height);
}

Result<void> check_aligned(const ForeignPicture& a, const ForeignPicture& b, std::string_view name,
                           std::string_view other) {
  const bool same_size = a.shown.width == b.shown.width && a.shown.height == b.shown.height;
  if (same_size && (a.shown == b.shown || (a.shown.x0 - a.display.x0 == b.shown.x0 - b.display.x0 &&
                                           a.shown.y0 - a.display.y0 == b.shown.y0 - b.display.y0)))
    return {};
  return fail(ErrorCode::kData,
              "{}: shows {} of its display window {}, {} {} of {}: save both alike, e.g. oiiotool "
              "--croptofull or --origin",
              name, text_of(a.shown), text_of(a.display), other, text_of(b.shown),
              text_of(b.display));
}

std::string text_of(const ExrWindow& window) {
  return fmt::format("x {} to {}, y {} to {}", window.x0, window.x0 + window.width - 1, window.y0,
                     window.y0 + window.height - 1);
}

std::string remark_line(const std::string& file, const ForeignPicture& picture) {
  std::vector<std::string> remarks = picture.remarks;
  std::size_t odd = 0;
  for (std::size_t i = 0; i < picture.rgb[0].size(); ++i)
    odd += !std::isfinite(picture.rgb[0][i] + picture.rgb[1][i] + picture.rgb[2][i]);
  if (odd > 0) remarks.push_back(counted(odd, "pixel is not finite", "pixels are not finite"));
  return remark_line(file, remarks);
}

std::string remark_line(const std::string& file, const std::vector<std::string>& remarks) {
  return remarks.empty() ? "" : fmt::format("{}: {}", file, fmt::join(remarks, "; "));
}

std::string unused_channels(const std::vector<ExrPart>& parts, const std::vector<ExrLayer>& layers,
                            const std::vector<std::pair<std::size_t, std::size_t>>& used) {
  std::vector<std::string> names;
  for (const ExrLayer& layer : layers) {
    std::vector<std::string> left;
    for (const auto& [channel, index] : layer.channels)
      if (std::find(used.begin(), used.end(), std::pair(layer.part, index)) == used.end())
        left.push_back(parts[layer.part].channels[index].name);
    if (left.size() > 1 && left.size() == layer.channels.size() && !layer.name.empty())
      left = {names.size() < kToldNames ? told(layer, parts, layers) : layer.name};
    names.insert(names.end(), left.begin(), left.end());
  }
  return listed(names);
}

}  // namespace spool
