#include "tools/show/shown_images.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "lib/image_io/picture.h"
#include "lib/metrics/error_metrics.h"
#include "tools/show/plane_text.h"
#include "tools/verbs/option_bounds.h"

namespace spool::tools {
namespace {

using nlohmann::ordered_json;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kBytesOfValue = 2.0 * 4.0 / 3.0;  // a half in base64; deflate may save some

bool finite_at(const RgbImage& image, std::size_t p) {
  return std::isfinite(image[0][p]) && std::isfinite(image[1][p]) && std::isfinite(image[2][p]);
}

// A metric is the mean of its map over the judged pixels (error_metrics.h).
ordered_json mean_where_judged(const Plane& map, const RgbImage& image, const RgbImage& reference) {
  double sum = 0.0;
  std::size_t n = 0;
  for (std::size_t p = 0; p < map.size(); ++p) {
    if (!finite_at(image, p) || !finite_at(reference, p)) continue;
    sum += map[p];
    ++n;
  }
  return n > 0 ? ordered_json(sum / static_cast<double>(n)) : ordered_json(nullptr);
}

const ErrorMap* find_map(const std::vector<ErrorMap>& maps, const std::string& metric) {
  const auto found = std::ranges::find(maps, metric, &ErrorMap::metric);
  return found == maps.end() ? nullptr : &*found;
}

void add_metrics(ordered_json& said, const std::vector<ErrorMap>& maps, const RgbImage& image,
                 const RgbImage& reference) {
  for (const char* metric : {"mse", "relmse", "flip_ldr"}) {
    const ErrorMap* map = find_map(maps, metric);
    said[metric] = map && said["not_finite"] == 0 ? mean_where_judged(map->parts, image, reference)
                                                  : ordered_json(nullptr);
  }
}

ordered_json plain_statistics(const RgbImage& image) {
  double sum = 0.0, low = std::numeric_limits<double>::infinity(), high = -low;
  std::size_t n = 0;
  for (std::size_t p = 0; p < image[0].size(); ++p) {
    if (!finite_at(image, p)) continue;
    sum += luminance(image[0][p], image[1][p], image[2][p]);
    low = std::min({low, image[0][p], image[1][p], image[2][p]});
    high = std::max({high, image[0][p], image[1][p], image[2][p]});
    ++n;
  }
  const auto known = [&](double value) { return n > 0 ? ordered_json(value) : nullptr; };
  return {{"luminance", known(sum / static_cast<double>(n))},
          {"smallest", known(low)},
          {"largest", known(high)},
          {"not_finite", image[0].size() - n}};
}

// FLIP is 0 where it is not known.
Plane flip_where_judged(Plane flip, const RgbImage& image, const RgbImage& reference) {
  for (std::size_t p = 0; p < flip.size(); ++p)
    if (!finite_at(image, p) || !finite_at(reference, p)) flip[p] = kNaN;
  return flip;
}

// Categories and angles have no mean.
template <class T>
Plane thinned(const Image<T>& plane, int factor) {
  Plane result((plane.width() + factor - 1) / factor, (plane.height() + factor - 1) / factor);
  for (int y = 0; y < result.height(); ++y)
    for (int x = 0; x < result.width(); ++x)
      result(x, y) = plane(x * factor, y * factor);
  return result;
}

RgbImage shrunk(const RgbImage& image, int factor) {
  return {tools::shrunk(image[0], factor), tools::shrunk(image[1], factor),
          tools::shrunk(image[2], factor)};
}

std::size_t values_of_pixel(const std::vector<ShownImage>& images, bool with_reference) {
  std::size_t values = with_reference ? 3 : 0;
  for (const ShownImage& shown : images) {
    values += 3 + (with_reference ? 2 : 0) + (shown.counts ? 1 : 0) + (shown.result.level ? 1 : 0) +
              (shown.result.dominant_direction ? 1 : 0);
  }
  return values;
}

// The smallest factor with which all planes fit.
int shrinking_factor(const Plane& plane, std::size_t values, double most_mb) {
  const double bytes = kBytesOfValue * static_cast<double>(values);
  const auto pixels = [&](int side, int factor) { return std::ceil(1.0 * side / factor); };
  int factor = 1;
  while (factor < std::max(plane.width(), plane.height()) &&
         bytes * pixels(plane.width(), factor) * pixels(plane.height(), factor) > 1e6 * most_mb)
    ++factor;
  return factor;
}

Result<void> check_images(const std::vector<ShownImage>& images, const RgbImage* reference,
                          const ShowSettings& settings) {
  if (images.empty()) return fail(ErrorCode::kUsage, "show: no image given: give at least one");
  if (images.size() > kMostShown) {
    return fail(ErrorCode::kUsage, "show: {} images: give at most {}", images.size(), kMostShown);
  }
  SPOOL_TRY(validate(settings));
  const Plane& first = images[0].result.image[0];
  if (first.empty()) return fail(ErrorCode::kUsage, "{}: has no pixels", images[0].name);
  const auto check = [&](const RgbImage& image, const std::string& name) -> Result<void> {
    if (image[0].same_size(first)) return {};
    return fail(ErrorCode::kUsage, "{}: is {} x {} pixels, {} is {} x {}: crop one of them", name,
                image[0].width(), image[0].height(), images[0].name, first.width(), first.height());
  };
  for (const ShownImage& shown : images)
    SPOOL_TRY(check(shown.result.image, shown.name));
  if (reference) SPOOL_TRY(check(*reference, "the reference"));
  for (const ShownCrop& c : settings.crops) {
    if (c.x >= 0 && c.y >= 0 && c.width > 0 && c.height > 0 && c.width <= first.width() &&
        c.height <= first.height() && c.x <= first.width() - c.width &&
        c.y <= first.height() - c.height)
      continue;
    return fail(ErrorCode::kUsage,
                "show: crop {},{},{},{}: x, y, width and height lie in {} x {} pixels", c.x, c.y,
                c.width, c.height, first.width(), first.height());
  }
  return {};
}

// EV in half steps that bring the picture's middle to grey, and the mean that scales errors.
void say_scales(PlaneText& text, const RgbImage& guide, const ShowSettings& settings) {
  const double found = std::log2(tone_exposure(guide));
  const ordered_json mean = plain_statistics(guide)["luminance"];
  text.say("exposure",
           settings.exposure.value_or(std::isfinite(found) ? std::round(2.0 * found) / 2.0 : 0.0));
  text.say("mean", mean.is_number() && mean > 0.0 ? mean : ordered_json(1.0));
}

void say_crops(PlaneText& text, const std::vector<ShownCrop>& crops, int factor) {
  ordered_json said = ordered_json::array();
  for (const ShownCrop& c : crops) {
    said.push_back({c.x / factor, c.y / factor, std::max(1, c.width / factor),
                    std::max(1, c.height / factor)});
  }
  text.say("crops", said);
}

// The planes of one image, "PLACE LAYER"; its numbers.
ordered_json add_image(PlaneText& text, const std::string& place, const ShownImage& shown,
                       const RgbImage* reference, int factor) {
  const Reconstruction& result = shown.result;
  text.add(place + " estimate", shrunk(result.image, factor));
  ordered_json said = plain_statistics(result.image);
  if (reference) {
    const std::vector<ErrorMap> maps = error_maps(result.image, {*reference, {}, {}});
    add_metrics(said, maps, result.image, *reference);
    text.add(place + " squared_error",
             tools::shrunk(squared_error_map(result.image, {*reference, {}, {}}), factor));
    if (const ErrorMap* flip = find_map(maps, "flip_ldr")) {
      text.add(place + " flip",
               tools::shrunk(flip_where_judged(flip->parts, result.image, *reference), factor));
    }
  }
  if (shown.counts) text.add(place + " density", thinned(*shown.counts, factor));
  if (result.level) text.add(place + " filter_size", thinned(*result.level, factor));
  if (result.dominant_direction)
    text.add(place + " direction", thinned(*result.dominant_direction, factor));
  return {{"name", shown.name}, {"filter", shown.filter}, {"spp", shown.spp}, {"statistics", said}};
}

}  // namespace

Result<void> validate(const ShowSettings& settings) {
  if (settings.exposure) SPOOL_TRY(check_bounds("exposure", *settings.exposure, kExposure));
  return check_bounds("megabytes of images", settings.most_mb, kShownMb);
}

ordered_json image_statistics(const RgbImage& image, const RgbImage* reference) {
  ordered_json said = plain_statistics(image);
  if (reference) add_metrics(said, error_maps(image, {*reference, {}, {}}), image, *reference);
  return said;
}

Plane shrunk(const Plane& plane, int factor) {
  if (factor == 1) return plane;
  Plane result((plane.width() + factor - 1) / factor, (plane.height() + factor - 1) / factor);
  for (int y = 0; y < result.height(); ++y) {
    for (int x = 0; x < result.width(); ++x) {
      const int right = std::min(plane.width(), (x + 1) * factor);
      const int below = std::min(plane.height(), (y + 1) * factor);
      double sum = 0.0;
      for (int v = y * factor; v < below; ++v)
        for (int u = x * factor; u < right; ++u)
          sum += plane(u, v);
      result(x, y) = sum / (1.0 * (right - x * factor) * (below - y * factor));
    }
  }
  return result;
}

Result<std::string> shown_planes(const std::vector<ShownImage>& images,
                                 const std::optional<RgbImage>& reference,
                                 const ShowSettings& settings) {
  const RgbImage* judge = reference ? &*reference : nullptr;
  SPOOL_TRY(check_images(images, judge, settings));
  const RgbImage& guide = judge ? *judge : images[0].result.image;
  const int factor =
      shrinking_factor(guide[0], values_of_pixel(images, judge != nullptr), settings.most_mb);
  PlaneText text((guide[0].width() + factor - 1) / factor,
                 (guide[0].height() + factor - 1) / factor);
  text.say("title", settings.title);
  text.say("whole", {guide[0].width(), guide[0].height()});
  text.say("shrunk", factor);
  text.say("reference", judge != nullptr ? plain_statistics(*judge) : ordered_json(nullptr));
  say_scales(text, guide, settings);
  say_crops(text, settings.crops, factor);
  ordered_json said = ordered_json::array();
  for (const ShownImage& shown : images)
    said.push_back(add_image(text, std::to_string(said.size()), shown, judge, factor));
  text.say("images", said);
  if (judge) text.add("reference", shrunk(*judge, factor));
  return text.text();
}

}  // namespace spool::tools
