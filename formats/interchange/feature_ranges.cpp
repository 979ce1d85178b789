#include "formats/interchange/feature_ranges.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <fmt/core.h>

#include "formats/interchange/layer_names.h"
#include "formats/stored_value.h"

namespace spool::interchange {
namespace {

using format::DataType;
using format::Semantic;

constexpr uint64_t kMostPixels = 16384;  // looked at, of a larger picture
constexpr uint64_t kLeastVectors = 16, kManyVectors = 1000;
constexpr uint64_t kLeastLevels = 32;  // of 256, that no light by chance has only
constexpr double kFar = 1e9;           // what a renderer writes where nothing is hit
constexpr double kTolerance = 0.05, kZero = 0.02;
constexpr const char* kFilm = "film";

// Length of factor * v + offset.
double length(std::span<const double> v, double factor, double offset) {
  double sum = 0;
  for (const double value : v)
    sum += (factor * value + offset) * (factor * value + offset);
  return std::sqrt(sum);
}

bool is_one(double length) {
  return std::abs(length - 1) <= kTolerance;
}

double percent(uint64_t part, uint64_t all) {
  return 100 * static_cast<double>(part) / static_cast<double>(all);
}

}  // namespace

FeatureRanges::FeatureRanges(uint64_t pixels) : stride_(pixels / kMostPixels + 1) {}

void FeatureRanges::add(const std::string& layer, size_t components, size_t pixels, size_t samples,
                        DataType type, std::span<const std::byte> planes) {
  const auto known = find_layer_name(layer);
  if (!known || type == DataType::kUint32 || components > 3) return;
  const Semantic kind = known->semantic;
  if (kind != Semantic::kDirection && kind != Semantic::kReflectance &&
      kind != Semantic::kDistance && kind != Semantic::kPosition && kind != Semantic::kLight &&
      layer != kFilm)
    return;
  Range& range = ranges_[layer];
  range.components = components;
  std::array<double, 3> v{};
  for (size_t p = 0; p < pixels; p += stride_) {
    for (size_t s = 0; s < samples; ++s) {
      for (size_t c = 0; c < components; ++c)
        v[c] = format::stored_value(planes, type, (c * pixels + p) * samples + s);
      if (kind == Semantic::kLight)
        add_light(range, std::span(v).first(components), type);
      else
        add_vector(range, std::span(v).first(components));
    }
  }
}

// As float16 has it, a multiple of 1 / 255 is rounded.
void FeatureRanges::add_light(Range& range, std::span<const double> v, DataType type) {
  const double tolerance = type == DataType::kFloat16 ? 0.07 : 1e-4;
  for (const double value : v) {
    ++range.values;
    for (const auto& [scale, levels] :
         {std::pair{1.0, &range.levels}, std::pair{255.0, &range.levels255}}) {
      const double level = std::round(scale * value);
      if (std::abs(scale * value - level) <= tolerance && level >= 0 && level <= 255)
        (*levels)[static_cast<size_t>(level)] += 1;
    }
  }
}

void FeatureRanges::add_vector(Range& range, std::span<const double> v) {
  for (size_t c = 0; c < v.size(); ++c) {
    if (std::isnan(v[c])) return;
    ++range.values;
    range.above += v[c] > 1.001 && std::isfinite(v[c]);
    range.below += v[c] < 0 && std::isfinite(v[c]);
    range.far += std::abs(v[c]) >= kFar;
  }
  const double size = length(v, 1, 0);
  if (size == 0 || size >= kFar) return;
  const bool first = range.vectors++ == 0;
  for (size_t c = 0; c < v.size(); ++c) {
    range.least[c] = first ? v[c] : std::min(range.least[c], v[c]);
    range.most[c] = first ? v[c] : std::max(range.most[c], v[c]);
  }
  range.shortest = first ? size : std::min(range.shortest, size);
  range.longest = std::max(range.longest, size);
  if (v.size() < 3) return;
  range.unit += is_one(size);
  const double twice = length(v, 2, -1);
  range.encoded += is_one(twice) || twice < kTolerance;  // the latter: nothing was hit
  range.encoded8 += is_one(length(v, 2.0 / 255, -1));
  range.forward += v[2] > kZero;
  range.backward += v[2] < -kZero;
  range.right += v[0] > kZero;
  range.left += v[0] < -kZero;
}

std::string FeatureRanges::of_direction(const std::string& layer, const Range& range) {
  if (range.components != 3 || range.vectors < kLeastVectors) return {};
  const double most = 0.95 * static_cast<double>(range.vectors);
  const auto nearly_all = [&](uint64_t count) { return static_cast<double>(count) >= most; };
  if (nearly_all(range.unit)) {
    const bool both = range.left > range.vectors / 20 && range.right > range.vectors / 20;
    const uint64_t one_side = std::max(range.forward, range.backward);
    if (range.vectors < kManyVectors || !both ||
        static_cast<double>(one_side) < 0.998 * static_cast<double>(range.vectors))
      return {};
    return fmt::format(
        "{}: Z is {} 0 in {:.4g} % of them, as in camera space: world space is expected, or "
        "meta.channels.{}.space that says camera",
        layer, one_side == range.forward ? "above" : "below", percent(one_side, range.vectors),
        layer);
  }
  if (range.below == 0 && range.most[0] <= 1.001 && nearly_all(range.encoded))
    return fmt::format("{}: encoded as n / 2 + 1 / 2 (no value is below 0): store 2 v - 1", layer);
  if (range.below == 0 && nearly_all(range.encoded8))
    return fmt::format("{}: encoded in 8 bits, 0 to 255: store 2 v / 255 - 1", layer);
  if (range.longest <= 1 + kTolerance && 2 * range.unit >= range.vectors) return {};
  return fmt::format(
      "{}: {:.3g} % have another length than 1 ({:.3g} to {:.3g}): they are means, "
      "or in another convention",
      layer, percent(range.vectors - range.unit, range.vectors), range.shortest, range.longest);
}

std::string FeatureRanges::of_light(const std::string& layer, const Range& range) {
  for (const auto& [levels, what, remedy] :
       {std::tuple{&range.levels, "whole numbers up to 255", "divide by 255 and linearise"},
        std::tuple{&range.levels255, "multiples of 1 / 255", "linearise, or save floats"}}) {
    uint64_t values = 0, seen = 0;
    for (const uint64_t count : *levels) {
      values += count;
      seen += count > 0;
    }
    if (values == range.values && seen >= kLeastLevels)
      return fmt::format("{}: all values are {}, as of 8-bit pictures: {}", layer, what, remedy);
  }
  return {};
}

std::string FeatureRanges::of_reflectance(const std::string& layer, const Range& range) {
  if (range.above > 0)
    return fmt::format(
        "{}: {:.3g} % of the values are above 1, the largest {:.4g}: reflectance is "
        "0 to 1",
        layer, percent(range.above, range.values),
        *std::max_element(range.most.begin(), range.most.end()));
  if (range.below > 0)
    return fmt::format("{}: {:.3g} % of the values are below 0: reflectance is 0 to 1", layer,
                       percent(range.below, range.values));
  return {};
}

std::string FeatureRanges::of_distance(const std::string& layer, const Range& range) const {
  if (range.components != 1 || range.vectors + range.far < kLeastVectors) return {};
  if (range.below > 0)
    return fmt::format(
        "{}: {:.3g} % of the values are below 0, down to {:.4g}: distances grow away "
        "from the camera",
        layer, percent(range.below, range.values), range.least[0]);
  if (range.far > 0)
    return fmt::format(
        "{}: {:.3g} % of the values are {:g} and more: where nothing is hit, 0 is "
        "expected",
        layer, percent(range.far, range.values), kFar);
  if (range.most[0] <= 1 && range.most[0] > 0.5)
    return fmt::format(
        "{}: between {:.4g} and {:.4g}: is it scaled to 0 .. 1, or of a depth buffer? "
        "Distances in the scene's units are expected",
        layer, range.least[0], range.most[0]);
  const auto position = ranges_.find(layer == "depth_ns" ? "position_ns" : "position");
  if (position == ranges_.end() || position->second.vectors < kLeastVectors) return {};
  std::array<double, 3> sides{};
  for (size_t c = 0; c < 3; ++c)
    sides[c] = position->second.most[c] - position->second.least[c];
  const double span = range.most[0] - range.least[0], widest = length(sides, 1, 0);
  // Distances of two points from the camera differ by no more than the points lie apart.
  if (span <= 1.5 * widest && (span == 0 || widest <= 100 * span)) return {};
  return fmt::format("{}: spans {:.3g} where {} spans {:.3g}: they are in different units", layer,
                     span, position->first, widest);
}

std::string FeatureRanges::of_film(const Range& range) {
  const double least = *std::min_element(range.least.begin(), range.least.end());
  const double most = *std::max_element(range.most.begin(), range.most.end());
  if (range.below == 0 && range.far == 0 && most < 1) return {};
  return fmt::format(
      "{}: from {:.6g} to {:.6g}: positions inside the pixel are expected, 0 to below 1: store v - "
      "floor(v)",
      kFilm, least, most);
}

std::vector<std::string> FeatureRanges::remarks() const {
  std::vector<std::string> found;
  for (const auto& [layer, range] : ranges_) {
    const Semantic kind = find_layer_name(layer)->semantic;
    std::string remark = kind == Semantic::kDirection     ? of_direction(layer, range)
                         : kind == Semantic::kReflectance ? of_reflectance(layer, range)
                         : kind == Semantic::kDistance    ? of_distance(layer, range)
                         : kind == Semantic::kLight       ? of_light(layer, range)
                         : layer == kFilm                 ? of_film(range)
                                                          : std::string();
    if (!remark.empty()) found.push_back(std::move(remark));
  }
  return found;
}

}  // namespace spool::interchange
