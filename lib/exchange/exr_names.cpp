#include "lib/exchange/exr_names.h"

#include <algorithm>
#include <optional>

#include "formats/interchange/layer_names.h"

namespace spool::exchange {
namespace {

// Layer -> channel (as spelt) -> plane.
using Theirs = std::map<std::string, std::map<std::string, size_t>>;

struct Synonym {
  std::string_view theirs, ours;
};

// Passes of Blender, before 5.0 and since.
constexpr Synonym kBlender[] = {
    {"Combined", "radiance"},
    {"Depth", "depth"},
    {"Position", "position"},
    {"Normal", "normal"},
    {"DiffCol", "albedo"},
    {"Diffuse Color", "albedo"},
    {"Denoising Normal", "normal_ns"},
    {"Denoising Albedo", "albedo_ns"},
    {"Denoising Depth", "depth_ns"},
};

// Layers of everybody else, in the order of preference. No name: the base layer.
constexpr Synonym kOthers[] = {
    {"", "radiance"},
    {"rgba", "radiance"},
    {"beauty", "radiance"},
    {"combined", "radiance"},
    {"color", "radiance"},
    {"colour", "radiance"},
    {"ns", "normal"},
    {"n", "normal"},
    {"normals", "normal"},
    {"sh_normal", "normal"},
    {"visiblenormals", "normal"},
    {"geo_normal", "normal_geo"},
    {"p", "position"},
    {"pos", "position"},
    {"diffuse_albedo", "albedo"},
    {"denoise_albedo", "albedo"},
    {"visiblediffuse", "albedo"},
    {"z", "depth"},
};

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return text;
}

// The planes of a layer for `count` components, by any of the usual spellings.
std::optional<std::vector<size_t>> planes_of(const std::map<std::string, size_t>& channels,
                                             const std::vector<std::string>& components) {
  std::map<std::string, size_t> found;
  for (const auto& [name, plane] : channels)
    found.emplace(lower(name), plane);
  const auto pick = [&](const std::vector<std::string>& names) {
    std::vector<size_t> planes;
    for (const std::string& name : names)
      if (const auto at = found.find(lower(name)); at != found.end()) planes.push_back(at->second);
    return planes.size() == names.size() ? std::optional(planes) : std::nullopt;
  };
  if (auto planes = pick(components)) return planes;
  if (components.size() == 3) {
    for (const auto& names :
         {std::vector<std::string>{"r", "g", "b"}, {"red", "green", "blue"}, {"x", "y", "z"}})
      if (auto planes = pick(names)) return planes;
  }
  if (components.size() == 1 && channels.size() == 1) return std::vector{channels.begin()->second};
  return std::nullopt;
}

struct Mapper {
  const ExrPlanes& image;
  ExrMapping mapping;
  std::vector<bool> used;

  bool has(std::string_view ours) const {
    return std::any_of(mapping.layers.begin(), mapping.layers.end(),
                       [&](const MappedLayer& layer) { return layer.name == ours; });
  }

  bool add(const std::string& ours, const std::map<std::string, size_t>& channels) {
    const auto known = interchange::find_layer_name(ours);
    std::vector<std::string> components;
    if (known) {
      components = known->components;
    } else {
      for (const auto& [name, plane] : channels)
        components.push_back(name);
    }
    const auto planes = planes_of(channels, components);
    if (has(ours) || !planes) return false;
    const PixelType type = image.planes[planes->front()].type;
    for (const size_t plane : *planes)
      if (image.planes[plane].type != type) return false;
    for (const size_t plane : *planes)
      used[plane] = true;
    mapping.layers.push_back({ours, components, *planes, format::Scope::kSample});
    return true;
  }
};

bool is_blender_pass(std::string_view pass) {
  return std::any_of(std::begin(kBlender), std::end(kBlender),
                     [&](const Synonym& row) { return row.theirs == pass; });
}

// "View.Layer.Combined" -> ("View.Layer", "Combined"); the base layer has no view layer.
void map_blender(Mapper& mapper, const Theirs& theirs) {
  std::string view_layer;
  for (const auto& [layer, channels] : theirs) {
    const auto [view, pass] = split_channel(layer);
    if (view.empty() || !is_blender_pass(pass)) continue;
    if (view_layer.empty() && pass == "Combined") view_layer = view;
  }
  for (const Synonym& row : kBlender) {
    const auto found = theirs.find(fmt::format("{}.{}", view_layer, row.theirs));
    if (!view_layer.empty() && found != theirs.end())
      mapper.add(std::string(row.ours), found->second);
  }
}

void map_others(Mapper& mapper, const Theirs& theirs) {
  // pbrt writes both: N of the surface and Ns as it is shaded.
  const bool both = theirs.contains("N") && theirs.contains("Ns");
  if (both) mapper.add("normal_geo", theirs.at("N"));
  for (const Synonym& row : kOthers)
    for (const auto& [layer, channels] : theirs)
      if (lower(layer) == row.theirs && !(both && layer == "N"))
        mapper.add(std::string(row.ours), channels);
  for (const auto& [layer, channels] : theirs)
    if (interchange::find_layer_name(lower(layer))) mapper.add(lower(layer), channels);
  // Z beside R, G, B without a layer.
  if (const auto base = theirs.find(""); base != theirs.end())
    if (const auto depth = base->second.find("Z"); depth != base->second.end())
      mapper.add("depth", {*depth});
}

Result<ExrMapping> map_told(const ExrPlanes& image, const ToldDump& told, const std::string& file) {
  ExrMapping mapping;
  for (const ToldChannel& channel : told.channels) {
    if (channel.scope != format::Scope::kSample) continue;
    const std::string theirs = channel.layer == "radiance" ? channel.component : channel.name();
    const auto plane = std::find_if(image.planes.begin(), image.planes.end(),
                                    [&](const ExrPlane& p) { return p.name == theirs; });
    if (plane == image.planes.end())
      return fail(ErrorCode::kData, "{}: no channel {}: was it dropped by a tool?", file, theirs);
    if (mapping.layers.empty() || mapping.layers.back().name != channel.layer)
      mapping.layers.push_back({channel.layer, {}, {}, format::Scope::kSample});
    MappedLayer& layer = mapping.layers.back();
    if (!layer.planes.empty() && image.planes[layer.planes[0]].type != plane->type)
      return fail(ErrorCode::kData,
                  "{}: the components of {} have different types: save them alike", file,
                  channel.layer);
    layer.components.push_back(channel.component);
    layer.planes.push_back(static_cast<size_t>(plane - image.planes.begin()));
  }
  return mapping;
}

}  // namespace

Result<ExrMapping> map_exr_layers(const ExrPlanes& image, const LayerMap& map,
                                  const std::string& file) {
  SPOOL_ASSIGN(const auto told, told_dump(image.attributes, file));
  if (told) return map_told(image, *told, file);
  Mapper mapper{image, {}, std::vector<bool>(image.planes.size())};
  Theirs theirs;
  for (size_t i = 0; i < image.planes.size(); ++i) {
    auto [layer, channel] = split_channel(image.planes[i].name);
    theirs[layer].emplace(std::move(channel), i);
  }
  for (const auto& [ours, name] : map) {
    const auto found = theirs.find(name);
    if (found == theirs.end() || !interchange::is_layer_name(ours) ||
        !mapper.add(ours, found->second))
      return fail(ErrorCode::kData,
                  "{}: import.map={}={}: there is no such layer with fitting channels", file, ours,
                  name);
  }
  map_blender(mapper, theirs);
  map_others(mapper, theirs);
  const auto radiance =
      std::find_if(mapper.mapping.layers.begin(), mapper.mapping.layers.end(),
                   [](const MappedLayer& layer) { return layer.name == "radiance"; });
  if (radiance == mapper.mapping.layers.end())
    return fail(ErrorCode::kData,
                "{}: no channels R, G, B and no pass Combined: name the layer with "
                "--set import.map=radiance=LAYER",
                file);
  std::rotate(mapper.mapping.layers.begin(), radiance, radiance + 1);
  for (size_t i = 0; i < image.planes.size(); ++i)
    if (!mapper.used[i]) mapper.mapping.dropped.push_back(shown(image.planes[i].name));
  return std::move(mapper.mapping);
}

}  // namespace spool::exchange
