#include "formats/interchange/layer_names.h"

#include <algorithm>

namespace spool::interchange {
namespace {

using format::Semantic;

struct Row {
  std::string_view layer;
  std::string_view components;  // one letter each, or one word
  Semantic semantic;
};

constexpr Row kRows[] = {
    {"radiance", "RGB", Semantic::kLight},
    {"diffuse", "RGB", Semantic::kLight},
    {"direct", "RGB", Semantic::kLight},
    {"film", "XY", Semantic::kSampleCoordinate},
    {"lens", "UV", Semantic::kSampleCoordinate},
    {"time", "T", Semantic::kSampleCoordinate},
    {"normal", "XYZ", Semantic::kDirection},
    {"normal_ns", "XYZ", Semantic::kDirection},
    {"normal_geo", "XYZ", Semantic::kDirection},
    {"albedo", "RGB", Semantic::kReflectance},
    {"albedo_ns", "RGB", Semantic::kReflectance},
    {"depth", "Z", Semantic::kDistance},
    {"depth_ns", "Z", Semantic::kDistance},
    {"position", "XYZ", Semantic::kPosition},
    {"position_ns", "XYZ", Semantic::kPosition},
    {"motion", "XYZ", Semantic::kPosition},
    {"visibility", "V", Semantic::kFraction},
    {"hit", "H", Semantic::kFraction},
    {"path", "flags", Semantic::kBits},
    {"seed", "S", Semantic::kBits},
    {"reference", "RGB", Semantic::kLight},
    {"reference_variance", "RGB", Semantic::kLightVariance},
};

}  // namespace

std::optional<LayerName> find_layer_name(std::string_view layer) {
  for (const Row& row : kRows) {
    if (row.layer != layer) continue;
    LayerName found{{}, row.semantic};
    if (row.layer == "path") {
      found.components.emplace_back(row.components);
    } else {
      for (char c : row.components)
        found.components.emplace_back(1, c);
    }
    return found;
  }
  return std::nullopt;
}

std::vector<uint16_t> own_semantics(const format::DumpHeader& header, const std::string& layer) {
  std::vector<uint16_t> semantics;
  for (const format::ChannelInfo& channel : header.channels)
    if (channel.name.starts_with(layer + ".")) semantics.push_back(channel.semantic);
  const auto known = find_layer_name(layer);
  const auto usual = static_cast<uint16_t>(known ? known->semantic : Semantic::kNotStated);
  if (std::ranges::all_of(semantics, [&](uint16_t s) { return s == usual; })) semantics.clear();
  return semantics;
}

std::vector<std::string> listed_layer_names() {
  std::vector<std::string> names;
  for (const Row& row : kRows)
    names.emplace_back(row.layer);
  return names;
}

bool is_layer_name(std::string_view layer) {
  const auto lower = [](char c) { return c >= 'a' && c <= 'z'; };
  return !layer.empty() && layer.size() <= 29 && lower(layer[0]) &&
         std::all_of(layer.begin(), layer.end(),
                     [&](char c) { return lower(c) || (c >= '0' && c <= '9') || c == '_'; });
}

bool is_reference_layer(std::string_view layer) {
  return layer == "reference" || layer == "reference_variance";
}

}  // namespace spool::interchange
