#include "lib/exchange/exr_names.h"

#include <algorithm>

#include "formats/interchange/layer_names.h"
#include "lib/core/visible_text.h"
#include "lib/image_io/foreign_picture.h"

namespace spool::exchange {
namespace {

struct Synonym {
  std::string_view theirs, ours;
};

// Passes of Blender, before 5.0 and since.
constexpr Synonym kBlender[] = {
    {"Depth", "depth"},
    {"Position", "position"},
    {"Normal", "normal"},
    {"DiffCol", "albedo"},
    {"Diffuse Color", "albedo"},
    {"Denoising Normal", "normal_ns"},
    {"Denoising Albedo", "albedo_ns"},
    {"Denoising Depth", "depth_ns"},
};

// Layers of everybody else, in the order of preference.
constexpr Synonym kOthers[] = {
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

// The channels of a layer for `count` components, by any of the usual spellings.
std::optional<std::vector<size_t>> channels_of(const std::map<std::string, size_t>& channels,
                                               const std::vector<std::string>& components) {
  std::map<std::string, size_t> found;
  for (const auto& [name, channel] : channels)
    found.emplace(lower_case(name), channel);
  const auto pick = [&](const std::vector<std::string>& names) {
    std::vector<size_t> picked;
    for (const std::string& name : names)
      if (const auto at = found.find(lower_case(name)); at != found.end())
        picked.push_back(at->second);
    return picked.size() == names.size() ? std::optional(picked) : std::nullopt;
  };
  if (auto picked = pick(components)) return picked;
  if (components.size() == 3) {
    for (const auto& names :
         {std::vector<std::string>{"r", "g", "b"}, {"red", "green", "blue"}, {"x", "y", "z"}})
      if (auto picked = pick(names)) return picked;
  }
  if (components.size() == 1 && channels.size() == 1) return std::vector{channels.begin()->second};
  return std::nullopt;
}

// The type that holds the values of all: a half is a float, exactly. Nothing for counts beside
// them.
std::optional<PixelType> common_type(const ExrPart& part, const std::vector<size_t>& channels) {
  PixelType type = part.channels[channels[0]].type;
  for (const size_t c : channels) {
    const PixelType other = part.channels[c].type;
    if ((other == PixelType::kUint) != (type == PixelType::kUint)) return std::nullopt;
    if (other != type) type = PixelType::kFloat;
  }
  return type;
}

const char* word_of(PixelType type) {
  return type == PixelType::kHalf ? "half" : type == PixelType::kUint ? "uint" : "float";
}

// Adds a layer, whose colours become those of Rec. 709, as floats.
Result<void> keep(MappedLayer layer, const ExrPart& part, const std::string& file,
                  ExrMapping& mapping) {
  if (layer.name == "radiance" && layer.type == PixelType::kUint)
    return fail(ErrorCode::kData,
                "{}: radiance holds whole numbers (uint), light has half or float: divide by the "
                "largest and linearise",
                file);
  if (layer.is_colour()) {
    SPOOL_ASSIGN(layer.conversion, conversion_to_rec709(part, file));
  }
  if (layer.conversion) {
    layer.type = PixelType::kFloat;
    mapping.converted.push_back(
        fmt::format("{} was converted from {} to Rec. 709", layer.name, layer.conversion->from));
  }
  mapping.layers.push_back(std::move(layer));
  return {};
}

class Mapper {
 public:
  Mapper(const std::vector<ExrPart>& parts, const std::string& file)
      : parts_(parts), file_(file), layers_(layers_of(parts)) {}

  Result<ExrMapping> map(const LayerMap& map) {
    LayerChoice choice = map.radiance;
    if (const auto named = map.layers.find("radiance"); named != map.layers.end())
      choice.layer = named->second;
    SPOOL_ASSIGN(const ChosenLayer chosen,
                 choose_layer(file_, parts_, layers_, choice, Taken::kSamples));
    if (!chosen.layer.colour)
      return fail(ErrorCode::kData,
                  "{}: {} has no R, G, B: radiance has three colours, save it so or choose a layer",
                  file_, spelt(chosen.layer));
    if (!chosen.remark.empty()) mapping_.notes.push_back(chosen.remark);
    radiance_ = chosen.layer;
    SPOOL_TRY(add("radiance", chosen.layer.part,
                  {chosen.layer.colour->begin(), chosen.layer.colour->end()}));
    for (const auto& [ours, theirs] : map.layers)
      if (ours != "radiance") SPOOL_TRY(add_named(ours, theirs));
    SPOOL_TRY(add_blender());
    SPOOL_TRY(add_others());
    list_dropped();
    return std::move(mapping_);
  }

 private:
  bool has(std::string_view ours) const {
    return std::any_of(mapping_.layers.begin(), mapping_.layers.end(),
                       [&](const MappedLayer& layer) { return layer.name == ours; });
  }

  // Of the view of radiance, in a part that is no deep one.
  bool beside_radiance(const ExrLayer& layer) const {
    return parts_[layer.part].flat && (layer.view.empty() || layer.view == radiance_.view);
  }

  Result<void> add(const std::string& ours, size_t part, const std::vector<size_t>& channels,
                   std::vector<std::string> components = {"R", "G", "B"}) {
    const auto type = common_type(parts_[part], channels);
    if (!type) {
      std::vector<std::string> types;
      for (const size_t c : channels)
        types.push_back(fmt::format("{} {}", parts_[part].channels[c].name,
                                    word_of(parts_[part].channels[c].type)));
      return fail(ErrorCode::kData,
                  "{}: components of {} have types that do not fit ({}): save "
                  "them in one type",
                  file_, ours, listed(types));
    }
    if (parts_[part].data != parts_[radiance_.part].data)
      return fail(ErrorCode::kData,
                  "{}: {} (part {}) has another data window than radiance (part {}): save them "
                  "alike",
                  file_, ours, part, radiance_.part);
    MappedLayer layer{ours, std::move(components), {}, *type};
    for (const size_t c : channels) {
      layer.planes.emplace_back(part, c);
      if (parts_[part].channels[c].type != *type)
        mapping_.converted.push_back(
            fmt::format("{}: half to float", parts_[part].channels[c].name));
    }
    return keep(std::move(layer), parts_[part], file_, mapping_);
  }

  // Where the layer has channels that fit; `taken` says whether it was.
  Result<bool> add_fitting(const std::string& ours, const ExrLayer& layer) {
    const auto known = interchange::find_layer_name(ours);
    std::vector<std::string> components;
    if (known) components = known->components;
    for (const auto& [name, channel] : layer.channels)
      if (!known) components.push_back(name);
    const auto channels = channels_of(layer.channels, components);
    if (has(ours) || !channels) return false;
    SPOOL_TRY(add(ours, layer.part, *channels, components));
    return true;
  }

  Result<void> add_named(const std::string& ours, const std::string& theirs) {
    std::vector<const ExrLayer*> found;
    for (const ExrLayer& layer : layers_)
      if (layer.name == theirs && parts_[layer.part].flat) found.push_back(&layer);
    if (found.size() > 1)
      return fail(ErrorCode::kData,
                  "{}: import.map={}={}: parts {} and {} have a layer of that name", file_, ours,
                  theirs, found[0]->part, found[1]->part);
    bool taken = false;
    if (!found.empty() && interchange::is_layer_name(ours)) {
      SPOOL_ASSIGN(taken, add_fitting(ours, *found[0]));
    }
    if (taken) return {};
    return fail(ErrorCode::kData,
                "{}: import.map={}={}: there is no such layer with fitting channels", file_, ours,
                theirs);
  }

  // "View.Layer.Depth" of the view layer of radiance.
  Result<void> add_blender() {
    if (radiance_.before.empty()) return {};
    for (const Synonym& row : kBlender) {
      for (const ExrLayer& layer : layers_) {
        if (layer.pass != row.theirs || layer.before != radiance_.before || !beside_radiance(layer))
          continue;
        SPOOL_TRY(add_fitting(std::string(row.ours), layer));
      }
    }
    return {};
  }

  // The layers called `theirs`; two that differ in letter case or part leave it open which is
  // meant.
  Result<void> add_only(const std::string& ours, std::string_view theirs, bool not_n) {
    std::vector<const ExrLayer*> found;
    for (const ExrLayer& layer : layers_)
      if (lower_case(layer.before.empty() ? layer.pass : layer.name) == theirs &&
          beside_radiance(layer) && !(not_n && layer.name == "N"))
        found.push_back(&layer);
    if (found.size() > 1 && !has(ours))
      return fail(ErrorCode::kData, "{}: {} may be {} or {}: choose with --set import.map={}=NAME",
                  file_, ours, told(*found[0], parts_, layers_), told(*found[1], parts_, layers_),
                  ours);
    for (const ExrLayer* layer : found)
      SPOOL_TRY(add_fitting(ours, *layer));
    return {};
  }

  Result<void> add_others() {
    const auto named = [&](std::string_view name) {
      return std::any_of(layers_.begin(), layers_.end(), [&](const ExrLayer& layer) {
        return layer.name == name && beside_radiance(layer);
      });
    };
    // pbrt writes both: N of the surface and Ns as it is shaded.
    const bool both = named("N") && named("Ns");
    if (both) SPOOL_TRY(add_exact("normal_geo", "N"));
    for (const Synonym& row : kOthers)
      SPOOL_TRY(add_only(std::string(row.ours), row.theirs, both));
    for (const ExrLayer& layer : layers_) {
      const std::string ours = lower_case(layer.name);
      if (interchange::find_layer_name(ours) && ours != "radiance" &&
          !interchange::is_reference_layer(ours))  // of one image among many, it is no reference
        SPOOL_TRY(add_only(ours, ours, false));
    }
    // Z beside R, G, B in their layer.
    for (const ExrLayer& layer : layers_) {
      const auto depth = layer.channels.find("Z");
      if (layer.part == radiance_.part && layer.name == radiance_.name &&
          depth != layer.channels.end() && !has("depth"))
        SPOOL_TRY(add("depth", layer.part, {depth->second}, {"Z"}));
    }
    return {};
  }

  Result<void> add_exact(const std::string& ours, std::string_view theirs) {
    for (const ExrLayer& layer : layers_)
      if (layer.name == theirs && beside_radiance(layer)) SPOOL_TRY(add_fitting(ours, layer));
    return {};
  }

  void list_dropped() {
    std::vector<ForeignChannel> used;
    for (const MappedLayer& layer : mapping_.layers)
      used.insert(used.end(), layer.planes.begin(), layer.planes.end());
    for (size_t p = 0; p < parts_.size(); ++p)
      for (size_t c = 0; c < parts_[p].channels.size(); ++c)
        if (std::find(used.begin(), used.end(), ForeignChannel{p, c}) == used.end())
          mapping_.dropped.push_back(printable_ascii(parts_[p].channels[c].name));
    if (const std::string unused = unused_channels(parts_, layers_, used); !unused.empty())
      mapping_.notes.push_back(
          fmt::format("not taken over: {} (--set import.map=OURS=LAYER takes a layer)", unused));
  }

  const std::vector<ExrPart>& parts_;
  const std::string& file_;
  const std::vector<ExrLayer> layers_;
  ExrLayer radiance_;
  ExrMapping mapping_;
};

Result<ExrMapping> map_told(const ExrPart& part, const ToldDump& told, const std::string& file) {
  std::vector<MappedLayer> layers;
  for (const ToldChannel& channel : told.channels) {
    if (channel.scope != format::Scope::kSample) continue;
    const std::string theirs = channel.layer == "radiance" ? channel.component : channel.name();
    const auto found = std::ranges::find(part.channels, theirs, &ExrChannel::name);
    if (found == part.channels.end())
      return fail(ErrorCode::kData, "{}: no channel {}: was it dropped by a tool?", file, theirs);
    if (layers.empty() || layers.back().name != channel.layer)
      layers.push_back(
          {channel.layer, {}, {}, found->type, std::nullopt, told.semantics(channel.layer)});
    MappedLayer& layer = layers.back();
    if (layer.type != found->type)
      return fail(ErrorCode::kData,
                  "{}: the components of {} have different types: save them alike", file,
                  channel.layer);
    layer.components.push_back(channel.component);
    layer.planes.emplace_back(0, static_cast<size_t>(found - part.channels.begin()));
  }
  ExrMapping mapping;
  for (MappedLayer& layer : layers)
    SPOOL_TRY(keep(std::move(layer), part, file, mapping));
  return mapping;
}

}  // namespace

Result<ExrMapping> map_exr_layers(const std::vector<ExrPart>& parts, const LayerMap& map,
                                  const std::string& file) {
  SPOOL_ASSIGN(const auto told, told_dump(parts[0].attributes, file));
  if (told) return map_told(parts[0], *told, file);
  return Mapper(parts, file).map(map);
}

}  // namespace spool::exchange
