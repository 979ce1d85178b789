#include "lib/exchange/exr_folder_import.h"

#include <charconv>
#include <map>

#include "formats/interchange/layer_names.h"
#include "formats/temporary_file.h"
#include "lib/core/nearest_name.h"
#include "lib/exchange/numbered_files.h"
#include "lib/exchange/pixel_layers.h"
#include "lib/exchange/sample_image.h"
#include "lib/image_io/foreign_picture.h"

namespace spool::exchange {

using format::FileHandle;
using format::Scope;
using interchange::DumpPlan;
using interchange::ForeignLayer;
using interchange::ImportReport;

namespace {

struct ExrFolderImportOptions : interchange::ImportOptions {
  LayerMap map;
};

constexpr const char* kPixelFile = "pixel_layers.exr";

Result<std::vector<ExrPart>> parts_of(const std::filesystem::path& path) {
  return ExrSource::open(path).map([](const ExrSource& source) { return source.parts(); });
}

// Layers of the plan with their places in the scratch file; returns its end.
uint64_t plan_layers(const ExrMapping& mapping, DumpPlan& plan) {
  uint64_t end = 0;
  for (const MappedLayer& mapped : mapping.layers) {
    ForeignLayer layer{mapped.name, mapped.components, Scope::kSample, {}, mapped.semantics};
    layer.array.offset = end;
    layer.array.type = element_type(mapped.type);
    layer.array.sample_major = true;
    layer.array.width = plan.width;
    layer.array.height = plan.height;
    layer.array.samples = plan.spp;
    layer.array.components = static_cast<uint32_t>(mapped.planes.size());
    end += layer.array.bytes();
    plan.layers.push_back(std::move(layer));
  }
  return end;
}

struct PassValue {
  interchange::ElementType type;
  uint32_t bits;
};

// "f32:3f800000": nothing for what no export writes.
std::optional<PassValue> pass_value(const ExrAttributes& attributes, const std::string& key) {
  using enum interchange::ElementType;
  const auto found = attributes.texts.find(key);
  if (found == attributes.texts.end() || found->second.size() != 12) return std::nullopt;
  const std::string_view text = found->second, type = text.substr(0, 4);
  PassValue value{type == "f16:" ? kFloat16 : type == "u32:" ? kUint32 : kFloat32, 0};
  const char* end = text.data() + text.size();
  if (std::from_chars(text.data() + 4, end, value.bits, 16).ptr != end ||
      (value.type == kFloat32 && type != "f32:") || (value.type == kFloat16 && value.bits > 0xffff))
    return std::nullopt;
  return value;
}

// Adds a pass-scope layer of our own export, one number per image and component.
Result<void> plan_pass_layer(ForeignLayer layer, const std::vector<ExrAttributes>& attributes,
                             const std::string& in, uint64_t& end, FileHandle& scratch,
                             DumpPlan& plan) {
  std::vector<std::byte> values;
  for (size_t s = 0; s < attributes.size(); ++s) {
    for (const std::string& component : layer.components) {
      const auto key = "spoolPass." + layer.name + "." + component;
      const auto value = pass_value(attributes[s], key);
      if (!value)
        return fail(ErrorCode::kData, "{}: image {} has no attribute {}: a tool dropped it", in, s,
                    key);
      if (!values.empty() && value->type != layer.array.type)
        return fail(ErrorCode::kData,
                    "{}: {} changes its type (image {}): was an attribute edited?", in, layer.name,
                    s);
      layer.array.type = value->type;
      const auto* raw = reinterpret_cast<const std::byte*>(&value->bits);
      values.insert(values.end(), raw, raw + interchange::element_bytes(value->type));
    }
  }
  layer.array.offset = end;
  layer.array.samples = plan.spp;
  layer.array.components = static_cast<uint32_t>(layer.components.size());
  SPOOL_TRY(scratch.write_at(end, values));
  end += values.size();
  plan.layers.push_back(std::move(layer));
  return {};
}

Result<void> plan_pass_layers(const ToldDump& told, const std::vector<ExrAttributes>& attributes,
                              const std::string& in, uint64_t& end, FileHandle& scratch,
                              DumpPlan& plan) {
  std::vector<ForeignLayer> layers;
  for (const ToldChannel& channel : told.channels) {
    if (channel.scope != Scope::kPass) continue;
    if (layers.empty() || layers.back().name != channel.layer)
      layers.push_back({channel.layer, {}, Scope::kPass, {}, told.semantics(channel.layer)});
    layers.back().components.push_back(channel.component);
  }
  for (ForeignLayer& layer : layers)
    SPOOL_TRY(plan_pass_layer(std::move(layer), attributes, in, end, scratch, plan));
  return {};
}

// An export of our own says how many images it had.
Result<void> check_complete(const ToldDump& told, const std::vector<std::filesystem::path>& files,
                            const std::string& in) {
  if (!told.samples || *told.samples == static_cast<double>(files.size())) return {};
  return fail(ErrorCode::kData,
              "{}: {} images, {} says that the recording had {} samples: copy the folder again, or "
              "export again",
              in, files.size(), files[0].filename().string(), *told.samples);
}

// Images of another recording between them would be samples of this one.
Result<void> check_source(const ExrAttributes& first, const ExrAttributes& image,
                          const std::filesystem::path& file) {
  if (source_of(first) == source_of(image)) return {};
  return fail(
      ErrorCode::kData,
      "{}: of another recording than the first image: export both anew, each to a folder of "
      "its own",
      file.string());
}

// The values of every image into the scratch file; their attributes.
Result<std::vector<ExrAttributes>> read_images(const std::filesystem::path& in,
                                               const std::vector<std::filesystem::path>& files,
                                               const std::vector<ExrPart>& first,
                                               const ExrMapping& mapping, FileHandle& scratch,
                                               DumpPlan& plan) {
  std::vector<ExrAttributes> attributes;
  std::vector<std::byte> first_radiance;
  bool all_alike = files.size() > 1;
  std::map<std::string, size_t> lossy;  // compression -> how many images have it
  for (size_t s = 0; s < files.size(); ++s) {
    SPOOL_ASSIGN(SampleImage image, read_sample_image(files[s], first, mapping));
    for (const std::string& compression : image.lossy)
      ++lossy[compression];
    for (size_t l = 0; l < mapping.layers.size(); ++l) {
      const std::vector<std::byte>& values = image.layers[l];
      SPOOL_TRY(scratch.write_at(plan.layers[l].array.offset + s * values.size(), values));
      if (l > 0) continue;
      all_alike = all_alike && (s == 0 || values == first_radiance);
      if (s == 0) first_radiance = values;
    }
    attributes.push_back(std::move(image.attributes));
    SPOOL_TRY(check_source(attributes[0], attributes[s], files[s]));
    SPOOL_ASSIGN(const FileHandle file, FileHandle::open(files[s], format::OpenMode::kRead));
    SPOOL_ASSIGN(interchange::ForeignFile identity, interchange::identify(file));
    plan.record.files.push_back(std::move(identity));
  }
  if (all_alike)
    return fail(ErrorCode::kData, "{}: all {} images are alike: the seed did not change",
                in.string(), files.size());
  for (const auto& [compression, images] : lossy)
    plan.record.converted.push_back(lossy_remark(compression, images, files.size()));
  return attributes;
}

Result<ImportReport> import_exr_folder(const std::filesystem::path& in,
                                       const std::filesystem::path& out,
                                       const ExrFolderImportOptions& options) {
  SPOOL_TRY(format::refuse_existing_target(out, options.force));
  if (!options.map.radiance.layer.empty() && options.map.layers.contains("radiance"))
    return fail(ErrorCode::kUsage,
                "{}: --layer {} and import.map=radiance={} both choose radiance: give one",
                in.string(), options.map.radiance.layer, options.map.layers.at("radiance"));
  SPOOL_ASSIGN(const NumberedFiles numbered, numbered_files(in, kPixelFile));
  const std::vector<std::filesystem::path>& files = numbered.paths;
  SPOOL_ASSIGN(const std::vector<ExrPart> first, parts_of(files[0]));
  SPOOL_ASSIGN(const ExrMapping mapping, map_exr_layers(first, options.map, files[0].string()));
  SPOOL_ASSIGN(auto told, told_dump(first[0].attributes, files[0].string()));
  if (told) SPOOL_TRY(check_complete(*told, files, in.string()));
  const ExrPart& part = first[mapping.layers[0].planes[0].first];
  const ExrWindow& window = part.data;
  SPOOL_TRY(check_size(window, files[0].string()));
  DumpPlan plan;
  plan.width = static_cast<uint32_t>(window.width);
  plan.height = static_cast<uint32_t>(window.height);
  plan.spp = static_cast<uint32_t>(files.size());
  uint64_t end = plan_layers(mapping, plan);
  uint64_t source_bytes = 0;
  std::error_code unreadable;
  for (const auto& file : files)
    source_bytes += std::filesystem::file_size(file, unreadable);
  SPOOL_TRY(options.expansion.check(in.string(), end, source_bytes));
  SPOOL_ASSIGN(FileHandle scratch, format::open_scratch_file(out));
  SPOOL_ASSIGN(const auto attributes, read_images(in, files, first, mapping, scratch, plan));
  if (told) SPOOL_TRY(plan_pass_layers(*told, attributes, in.string(), end, scratch, plan));
  std::error_code ignored;
  if ((told && told->has_pixel_layers()) || std::filesystem::exists(in / kPixelFile, ignored))
    SPOOL_TRY(
        read_pixel_layers(told, source_of(attributes[0]), in / kPixelFile, end, scratch, plan));
  for (ForeignLayer& layer : plan.layers)
    layer.array.file = &scratch;
  plan.sample_order =
      told ? told->sample_order : options.sample_order.value_or(format::SampleOrder::kRenderer);
  if (told) plan.meta = told->meta;
  plan.record.format = "exr-folder";
  plan.record.options["map"] = options.map.layers;
  plan.record.dropped = mapping.dropped;
  plan.record.converted.insert(plan.record.converted.begin(), mapping.converted.begin(),
                               mapping.converted.end());
  if (window.x0 != 0 || window.y0 != 0)
    plan.record.converted.push_back(
        fmt::format("the data window began at {},{} and was moved to 0,0", window.x0, window.y0));
  if (part.display != window)
    plan.record.converted.push_back(
        fmt::format("all of the data window ({}) was taken, the display window is another ({})",
                    text_of(window), text_of(part.display)));
  std::vector<std::string> notes = plan.record.converted;
  notes.insert(notes.end(), numbered.notes.begin(), numbered.notes.end());
  notes.insert(notes.end(), mapping.notes.begin(), mapping.notes.end());
  SPOOL_ASSIGN(ImportReport report, write_dump(out, std::move(plan), options));
  report.notes.insert(report.notes.begin(), notes.begin(), notes.end());
  return report;
}

// A name of one's own is a layer, too: only what is long enough to be one of the page misspelt, and
// is none with something added, is not taken.
Result<void> add_to_map(LayerMap& map, const std::string& ours, const std::string& theirs) {
  const std::vector<std::string> listed = interchange::listed_layer_names();
  const std::string near = nearest_name(ours, listed);
  const auto in = [](const std::string& a, const std::string& b) {
    return b.find(a) != std::string::npos;
  };
  if (ours.size() > 5 && !near.empty() && !in(near, ours) && !in(ours, near))
    return fail(ErrorCode::kUsage, "option map: {}", unknown_name("layer", ours, listed));
  if (!map.layers.emplace(ours, theirs).second)
    return fail(ErrorCode::kUsage, "option map: {} is there twice: give it one layer", ours);
  return {};
}

Option<ExrFolderImportOptions> radiance_option(std::string name, std::string LayerChoice::* member,
                                               std::string help) {
  using O = ExrFolderImportOptions;
  return {std::move(name), "NAME", std::move(help),
          [=](O& options, std::string_view text) -> Result<void> {
            options.map.radiance.*member = text;
            return {};
          },
          [=](const O& options) { return options.map.radiance.*member; }};
}

}  // namespace

interchange::ImportFormat exr_folder_format() {
  using O = ExrFolderImportOptions;
  return interchange::import_format<O>(
      "exr-folder", "one EXR image per sample, ordered by the last number in the name",
      {interchange::exchangeable_option<O>(),
       {"map", "OURS=LAYER", "which layer is, say, the albedo: map=albedo=DiffCol; several times",
        [](O& options, std::string_view text) -> Result<void> {
          const std::size_t equals = text.find('=');
          if (equals == std::string_view::npos || equals == 0) {
            return fail(ErrorCode::kUsage, "option map: '{}' is no OURS=LAYER, e.g. albedo=DiffCol",
                        text);
          }
          return add_to_map(options.map, std::string(text.substr(0, equals)),
                            std::string(text.substr(equals + 1)));
        },
        [](const O& options) {
          std::string text;
          for (const auto& [ours, theirs] : options.map.layers)
            text += fmt::format("{}{}={}", text.empty() ? "" : " ", ours, theirs);
          return text.empty() ? "none" : text;
        }},
       radiance_option("layer", &LayerChoice::layer, "the layer that is radiance, as --layer"),
       radiance_option("part", &LayerChoice::part, "the part that has it, as --part")},
      import_exr_folder);
}

}  // namespace spool::exchange
