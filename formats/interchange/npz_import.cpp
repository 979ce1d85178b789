#include "formats/interchange/npz_import.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "formats/interchange/layer_names.h"
#include "formats/interchange/npz_members.h"
#include "formats/temporary_file.h"

namespace spool::interchange {
namespace {

using format::FileHandle;
using format::Scope;
using nlohmann::json;

enum class NpzLayout { kHWSC, kSHWC };  // [y][x][s][c], [s][y][x][c]

struct NpzImportOptions : ImportOptions {
  std::optional<NpzLayout> layout;
  bool narrow = false;  // take f8 and round it to f4
};

std::optional<ElementType> element_type(const std::string& type) {
  static const std::map<std::string, ElementType> types = {
      {"<f2", ElementType::kFloat16}, {"<f4", ElementType::kFloat32},
      {"<f8", ElementType::kFloat64}, {"<u4", ElementType::kUint32},
      {"|u1", ElementType::kUint8},   {"|b1", ElementType::kUint8}};
  const auto found = types.find(type);
  return found == types.end() ? std::nullopt : std::optional(found->second);
}

// A string option of `meta`; nullopt when the key is absent.
Result<std::optional<std::string>> text_of(const json& meta, const char* key,
                                           std::initializer_list<std::string_view> allowed,
                                           const std::string& file) {
  if (!meta.contains(key)) return std::nullopt;
  const json& value = meta[key];
  if (value.is_string() &&
      std::find(allowed.begin(), allowed.end(), value.get<std::string>()) != allowed.end())
    return value.get<std::string>();
  return fail(ErrorCode::kData, "{}: meta.{} is {}: one of {} is possible", file, key,
              value.dump(-1, ' ', true), fmt::join(allowed, ", "));
}

Result<Scope> scope_of(const json& meta, const std::string& layer, const std::string& file) {
  if (meta.contains("scope") && !meta["scope"].is_object())
    return fail(ErrorCode::kData, "{}: meta.scope is not an object: give {{layer: scope}}", file);
  if (meta.contains("scope")) {
    SPOOL_ASSIGN(const auto scope,
                 text_of(meta["scope"], layer.c_str(), {"sample", "pixel", "pass"}, file));
    if (scope)
      return *scope == "pixel" ? Scope::kPixel : *scope == "pass" ? Scope::kPass : Scope::kSample;
  }
  return layer.starts_with("reference") ? Scope::kPixel : Scope::kSample;
}

// meta.channels.LAYER is the list of components, or an object of remarks that holds it.
const json* component_list(const json& meta, const std::string& layer) {
  if (!meta.contains("channels") || !meta["channels"].is_object()) return nullptr;
  const json& channels = meta["channels"];
  if (!channels.contains(layer)) return nullptr;
  const json& entry = channels[layer];
  if (entry.is_array()) return &entry;
  return entry.is_object() && entry.contains("components") && entry["components"].is_array()
             ? &entry["components"]
             : nullptr;
}

Result<std::vector<std::string>> components_of(const json& meta, const std::string& layer,
                                               const std::string& file) {
  if (const json* list = component_list(meta, layer)) {
    std::vector<std::string> components;
    for (const json& component : *list) {
      if (!component.is_string())
        return fail(ErrorCode::kData, "{}: meta.channels.{} is not a list of names", file, layer);
      components.push_back(component.get<std::string>());
    }
    return components;
  }
  if (auto known = find_layer_name(layer)) return known->components;
  return fail(ErrorCode::kData, "{}: {}: unknown layer: name its components in meta.channels", file,
              layer);
}

// meta.semantic.LAYER, a number of formats/spool.md 4.2 for each component; empty where it has
// none.
Result<std::vector<uint16_t>> semantics_of(const json& meta, const ForeignLayer& layer,
                                           const std::string& file) {
  std::vector<uint16_t> semantics;
  if (!meta.contains("semantic") || !meta["semantic"].is_object()) return semantics;
  const json given = meta["semantic"].value(layer.name, json());
  if (given.is_null()) return semantics;
  const auto known = [](const json& number) {
    return number.is_number_unsigned() &&
           number.get<uint64_t>() <= static_cast<uint64_t>(format::Semantic::kBits);
  };
  if (!given.is_array() || given.size() != layer.components.size() ||
      !std::ranges::all_of(given, known))
    return fail(ErrorCode::kData,
                "{}: meta.semantic.{} is {}: give a number from 0 to 9 for each component", file,
                layer.name, given.dump(-1, ' ', true));
  return given.get<std::vector<uint16_t>>();
}

// Of what is measured they are encoded: a display's light, reflectance or normals in bytes.
Result<void> refuse_whole_numbers(const NpzMember& member, const std::string& name) {
  using format::Semantic;
  const auto known = find_layer_name(member.layer);
  const Semantic kind = known ? known->semantic : Semantic::kNotStated;
  if (kind == Semantic::kNotStated || kind == Semantic::kBits || kind == Semantic::kFraction)
    return {};
  const bool light = kind == Semantic::kLight || kind == Semantic::kLightVariance;
  return fail(ErrorCode::kData, "{}: dtype {} is {}, and save with astype('<f4')", name,
              member.header.type,
              light ? "no light: divide by the largest value, linearise where it is sRGB"
                    : "encoded: decode it (reflectance v / 255, directions 2 v / 255 - 1)");
}

// Axes of a layer, in words for the message and as sizes.
Result<ForeignLayer> plan_layer(const NpzMember& member, const json& meta, bool sample_major,
                                bool narrow, const std::string& file) {
  ForeignLayer layer;
  layer.name = member.layer;
  const std::string name = fmt::format("{}: {}", file, member.layer);
  const auto type = element_type(member.header.type);
  if (std::string_view("uib").find(member.header.type[1]) != std::string_view::npos)
    SPOOL_TRY(refuse_whole_numbers(member, name));
  if (!type)
    return fail(
        ErrorCode::kData, "{}: dtype {}: {}save with astype('<f4')", name, member.header.type,
        member.header.type[1] == 'f' ? "" : "no real numbers, take what is meant of it and ");
  if (*type == ElementType::kFloat64 && !narrow)
    return fail(ErrorCode::kData,
                "{}: dtype <f8: save with astype('<f4') or --set import.narrow=on", name);
  SPOOL_ASSIGN(layer.scope, scope_of(meta, member.layer, file));
  SPOOL_ASSIGN(layer.components, components_of(meta, member.layer, file));
  SPOOL_ASSIGN(layer.semantics, semantics_of(meta, layer, file));
  std::vector<uint64_t> shape = member.header.shape;
  const size_t axes = layer.scope == Scope::kSample ? 3 : layer.scope == Scope::kPixel ? 2 : 1;
  if (shape.size() == axes && layer.components.size() == 1) shape.push_back(1);
  if (shape.size() != axes + 1)
    return fail(ErrorCode::kData, "{}: shape {}, expected {} axes, {}", name,
                shape_text(member.header.shape), axes + 1,
                axes == 3   ? "[y][x][s][component] or [s][y][x][component]"
                : axes == 2 ? "[y][x][component]"
                            : "[s][component]");
  if (shape.back() != layer.components.size())
    return fail(ErrorCode::kData, "{}: shape {}, expected {} components", name,
                shape_text(member.header.shape), layer.components.size());
  for (uint64_t axis : shape)
    if (axis == 0 || axis > UINT32_MAX)
      return fail(ErrorCode::kData, "{}: shape {}: nothing can be stored in it", name,
                  shape_text(member.header.shape));
  const auto at = [&](size_t axis) { return static_cast<uint32_t>(shape[axis]); };
  layer.array.type = *type;
  layer.array.components = at(axes);
  if (layer.scope == Scope::kSample) {
    layer.array.sample_major = sample_major;
    layer.array.height = at(sample_major ? 1 : 0);
    layer.array.width = at(sample_major ? 2 : 1);
    layer.array.samples = at(sample_major ? 0 : 2);
  } else if (layer.scope == Scope::kPixel) {
    layer.array.height = at(0);
    layer.array.width = at(1);
  } else {
    layer.array.samples = at(0);
  }
  return layer;
}

Result<void> check_sizes(const DumpPlan& plan, const std::string& file) {
  for (const ForeignLayer& layer : plan.layers) {
    const SampleArray& array = layer.array;
    const bool image = layer.scope != Scope::kPass, samples = layer.scope != Scope::kPixel;
    if ((image && (array.height != plan.height || array.width != plan.width)) ||
        (samples && array.samples != plan.spp))
      return fail(ErrorCode::kData,
                  "{}: {} is {}x{} with {} samples but radiance is {}x{} with {}: save them alike",
                  file, layer.name, array.width, array.height, array.samples, plan.width,
                  plan.height, plan.spp);
  }
  return {};
}

// Gives every layer its file and offset, with all checksums verified.
Result<FileHandle> locate(const FileHandle& file, const std::vector<NpzMember>& members,
                          const std::filesystem::path& out, DumpPlan& plan) {
  FileHandle inflated;
  uint64_t end = 0;
  std::map<std::string, uint64_t> inflated_at;
  for (const NpzMember& member : members) {
    if (member.layer == "meta") continue;
    if (member.zip.deflated && inflated_at.empty()) {
      SPOOL_ASSIGN(inflated, format::open_scratch_file(out));
    }
    if (member.zip.deflated) inflated_at[member.layer] = end;
    const auto keep = [&](std::span<const std::byte> piece) -> Result<void> {
      if (!member.zip.deflated) return {};
      end += piece.size();
      return inflated.write_at(end - piece.size(), piece);
    };
    SPOOL_TRY(decode_member(file, member.zip, keep));
  }
  for (ForeignLayer& layer : plan.layers) {
    const NpzMember& member = *std::find_if(
        members.begin(), members.end(), [&](const NpzMember& m) { return m.layer == layer.name; });
    layer.array.offset = member.header.header_bytes +
                         (member.zip.deflated ? inflated_at[layer.name] : member.zip.data_offset);
    layer.array.file = member.zip.deflated ? nullptr : &file;  // set by the caller: it may move
  }
  return inflated;
}

// Removes from `meta` what the recording itself says; remarks stay.
void drop_structure(json& meta, const DumpPlan& plan) {
  for (const char* key : {"spool_npz", "layout", "scope", "semantic", "sample_order",
                          "pixel_filter", "colour_space", "import"})
    meta.erase(key);
  if (!meta.contains("channels") || !meta["channels"].is_object()) return;
  json& channels = meta["channels"];
  for (const ForeignLayer& layer : plan.layers) {
    if (!channels.contains(layer.name)) continue;
    json& entry = channels[layer.name];
    if (entry.is_object()) entry.erase("components");
    if (entry.is_array() || entry.empty()) channels.erase(layer.name);
  }
  if (channels.empty()) meta.erase("channels");
}

void note_conversions(const std::vector<NpzMember>& members, ImportRecord& record) {
  for (const NpzMember& member : members) {
    if (member.layer == "meta") continue;
    if (member.header.type == "<f8") record.converted.push_back(member.layer + ": f8 to f4");
    if (member.header.type == "|u1" || member.header.type == "|b1")
      record.converted.push_back(member.layer + ": " + member.header.type.substr(1) + " to u4");
  }
}

// Layers, sizes and order of samples, as `meta` and the options have them; radiance comes first.
Result<DumpPlan> plan_members(const std::vector<NpzMember>& members, const json& meta,
                              const NpzImportOptions& options, const std::string& name) {
  DumpPlan plan;
  SPOOL_ASSIGN(const auto layout, text_of(meta, "layout", {"HWSC", "SHWC"}, name));
  SPOOL_ASSIGN(const auto order, text_of(meta, "sample_order", {"renderer", "exchangeable"}, name));
  SPOOL_TRY(text_of(meta, "pixel_filter", {"box"}, name).map([](const auto&) {}));
  SPOOL_TRY(text_of(meta, "colour_space", {"linear_rec709"}, name).map([](const auto&) {}));
  const bool sample_major = options.layout ? *options.layout == NpzLayout::kSHWC : layout == "SHWC";
  if (options.layout && layout && sample_major != (*layout == "SHWC"))
    return fail(ErrorCode::kUsage, "{}: meta.layout is {}: leave import.layout out", name, *layout);
  if (!options.layout && !layout)
    return fail(ErrorCode::kUsage,
                "{}: no meta.layout, so the order of axes is unknown: give --set "
                "import.layout=HWSC or SHWC",
                name);

  for (const NpzMember& member : members) {
    if (member.layer == "meta") continue;
    SPOOL_ASSIGN(ForeignLayer layer, plan_layer(member, meta, sample_major, options.narrow, name));
    plan.layers.push_back(std::move(layer));
  }
  const SampleArray& radiance = plan.layers[0].array;
  plan.height = radiance.height;
  plan.width = radiance.width;
  plan.spp = radiance.samples;
  plan.sample_order = order ? (*order == "exchangeable" ? format::SampleOrder::kExchangeable
                                                        : format::SampleOrder::kRenderer)
                            : options.sample_order.value_or(format::SampleOrder::kRenderer);
  SPOOL_TRY(check_sizes(plan, name));
  plan.record.options = {{"layout", sample_major ? "SHWC" : "HWSC"}, {"narrow", options.narrow}};
  return plan;
}

Result<ImportReport> import_npz(const std::filesystem::path& in, const std::filesystem::path& out,
                                const NpzImportOptions& options) {
  const std::string name = in.string();
  SPOOL_ASSIGN(const FileHandle file, FileHandle::open(in, format::OpenMode::kRead));
  SPOOL_TRY(format::refuse_existing_target(out, options.force));
  SPOOL_ASSIGN(std::vector<NpzMember> members, read_npz_members(file));
  const auto named = [&](std::string_view layer) {
    return std::find_if(members.begin(), members.end(),
                        [&](const NpzMember& member) { return member.layer == layer; });
  };
  if (named("radiance") == members.end())
    return fail(ErrorCode::kData,
                "{}: no array radiance, the first is {}: save light under that name, [y][x][s][3]",
                name, members.empty() ? "none" : members.front().layer);
  std::rotate(members.begin(), named("radiance"), named("radiance") + 1);

  json meta = json::object();
  if (named("meta") != members.end()) {
    SPOOL_ASSIGN(meta, read_npz_meta(file, *named("meta")));
  }
  SPOOL_ASSIGN(DumpPlan plan, plan_members(members, meta, options, name));
  drop_structure(meta, plan);
  plan.meta = std::move(meta);
  SPOOL_ASSIGN(ForeignFile identity, identify(file));
  plan.record.format = "npz";
  plan.record.files.push_back(std::move(identity));
  note_conversions(members, plan.record);

  SPOOL_TRY(options.expansion.check(name, stored_bytes(plan.layers), plan.record.files[0].bytes));
  SPOOL_ASSIGN(const FileHandle inflated, locate(file, members, out, plan));
  for (ForeignLayer& layer : plan.layers)
    if (layer.array.file == nullptr) layer.array.file = &inflated;
  return write_dump(out, std::move(plan), options);
}

}  // namespace

ImportFormat npz_format() {
  using O = NpzImportOptions;
  return import_format<O>(
      "npz", "numpy arrays: radiance [y][x][s][3], other layers, reference, meta",
      {exchangeable_option<O>(),
       open_choice_option<O, NpzLayout>(
           "layout", &O::layout, "meta", {{"HWSC", NpzLayout::kHWSC}, {"SHWC", NpzLayout::kSHWC}},
           "axes of arrays without `meta.layout`: S sample, C channel"),
       switch_option<O>("narrow", &O::narrow, "round 64-bit floats to 32 bits")},
      import_npz);
}

}  // namespace spool::interchange
