#include "lib/exchange/exr_folder_export.h"

#include <algorithm>
#include <cstring>
#include <map>

#include "formats/byte_io.h"
#include "formats/file_set.h"
#include "lib/exchange/exr_names.h"
#include "lib/exchange/pixel_layers.h"
#include "lib/image_io/exr_source.h"

namespace spool::exchange {

using format::LayerInfo;
using format::PixelRect;
using format::Scope;
using interchange::ExportReport;

namespace {

enum class ExrNames {
  kPlain,    // R, G, B and LAYER.COMPONENT, as OpenImageIO names them; comes back as it was
  kBlender,  // ViewLayer.Combined.R, ViewLayer.DiffCol.R, ...
  kRgb,      // R, G, B only
};

struct ExrFolderExportOptions : interchange::ExportOptions {
  ExrNames names = ExrNames::kPlain;
};

constexpr uint64_t kImageBytes = uint64_t{512} << 20;  // of the images that are open together

// The channel's name in the image; empty when the names have none for it.
std::string channel_name(const LayerInfo& layer, const std::string& component, ExrNames names) {
  static const std::map<std::string, std::string> blender = {{"radiance", "Combined"},
                                                             {"depth", "Depth"},
                                                             {"position", "Position"},
                                                             {"normal", "Normal"},
                                                             {"albedo", "DiffCol"},
                                                             {"normal_ns", "Denoising Normal"},
                                                             {"albedo_ns", "Denoising Albedo"},
                                                             {"depth_ns", "Denoising Depth"}};
  if (names == ExrNames::kBlender) {
    const auto found = blender.find(layer.name);
    return found == blender.end() ? "" : "ViewLayer." + found->second + "." + component;
  }
  if (layer.name == "radiance") return component;
  return names == ExrNames::kPlain ? layer.name + "." + component : "";
}

// A channel of the recording and its plane.
struct Place {
  LayerInfo layer;
  uint32_t channel = 0;  // of the group's blocks
  std::string name;
};

std::vector<ExrPlanes> blank_images(const format::DumpHeader& header, const ExrAttributes& about,
                                    const std::vector<Place>& places, uint32_t count) {
  ExrPlanes image;
  image.width = static_cast<int>(header.width);
  image.height = static_cast<int>(header.height);
  image.attributes = about;
  const uint64_t pixels = uint64_t{header.width} * header.height;
  for (const Place& place : places)
    image.planes.push_back(
        {place.name, pixel_type(place.layer.type),
         std::vector<std::byte>(pixels * format::bytes_per_value(place.layer.type))});
  return std::vector<ExrPlanes>(count, image);
}

// Samples [s0, s0 + images.size()) of a block of every tile into the images.
Result<void> fill_images(const format::SpoolReader& dump, const std::vector<Place>& places,
                         uint32_t block, uint32_t s0, std::vector<ExrPlanes>& images) {
  const uint64_t samples = dump.block_count(block);
  for (uint32_t tile = 0; tile < dump.tiles(); ++tile) {
    const PixelRect rect = dump.tile_rect(tile);
    const uint64_t pixels = uint64_t{rect.width()} * rect.height();
    std::vector<std::byte> payload;
    for (size_t p = 0; p < places.size(); ++p) {
      const Place& place = places[p];
      if (p == 0 || place.layer.group != places[p - 1].layer.group) {
        SPOOL_ASSIGN(payload, dump.read_block(place.layer.group, tile, block));
      }
      const uint64_t bytes = format::bytes_per_value(place.layer.type);
      for (uint64_t i = 0; i < pixels; ++i) {
        const uint64_t to =
            ((rect.y0 + i / rect.width()) * dump.header().width + rect.x0 + i % rect.width()) *
            bytes;
        const uint64_t from = ((place.channel * pixels + i) * samples + s0) * bytes;
        for (size_t s = 0; s < images.size(); ++s)
          std::memcpy(&images[s].planes[p].values[to], &payload[from + s * bytes], bytes);
      }
    }
  }
  return {};
}

// "f32:3f800000": type and bits, so that nothing is rounded.
Result<std::map<std::string, std::string>> pass_attributes(const format::SpoolReader& dump,
                                                           const LayerInfo& layer, uint32_t block,
                                                           uint32_t s) {
  SPOOL_ASSIGN(const auto payload, dump.read_block(layer.group, 0, block));
  const uint64_t bytes = format::bytes_per_value(layer.type);
  std::map<std::string, std::string> texts;
  for (uint32_t c = 0; c < layer.channel_count; ++c) {
    const uint64_t at = (uint64_t{layer.first_channel + c} * dump.block_count(block) + s) * bytes;
    const uint32_t bits =
        bytes == 2 ? format::load<uint16_t>(payload, at) : format::load<uint32_t>(payload, at);
    const char* type = bytes == 2 ? "f16" : layer.type == format::DataType::kUint32 ? "u32" : "f32";
    texts["spoolPass." + layer.name + "." + layer.components[c]] =
        fmt::format("{}:{:08x}", type, bits);
  }
  return texts;
}

constexpr const char* kPixelFile = "pixel_layers.exr";

std::string sample_name(uint32_t sample) {
  return fmt::format("sample_{:04}.exr", sample);
}

// Images of a longer recording would be samples of this one: those of an earlier export go, those
// of another program do not.
Result<void> add_earlier_images(const std::filesystem::path& out, std::vector<std::string>& names) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(out, error)) {
    const std::string name = entry.path().filename().string();
    const bool sample = name.starts_with("sample_") && name.ends_with(".exr");
    if ((!sample && name != kPixelFile) || std::ranges::count(names, name) > 0) continue;
    const auto source = ExrSource::open(entry.path());
    if (!source || source_of(source->parts()[0].attributes).empty())
      return fail(ErrorCode::kUsage,
                  "{}: is of no export by spool, and would be taken for one: move it away",
                  entry.path().string());
    names.push_back(name);
  }
  if (error)
    return fail(ErrorCode::kIo, "{}: cannot be listed ({}): check the folder", out.string(),
                error.message());
  return {};
}

// What of a recording goes where.
struct FolderPlan {
  std::vector<Place> places;
  std::vector<LayerInfo> pass_layers;
  bool pixel_layers = false;
  ExrAttributes about;
};

FolderPlan plan_folder(const format::SpoolReader& dump, ExrNames names, ExportReport& report) {
  const bool plain = names == ExrNames::kPlain;
  FolderPlan plan;
  for (const LayerInfo& layer : dump.layers()) {
    const bool named =
        layer.scope == Scope::kSample && !channel_name(layer, layer.components[0], names).empty();
    if (layer.scope == Scope::kPixel) plan.pixel_layers = true;
    if (layer.scope == Scope::kPass && plain) plan.pass_layers.push_back(layer);
    if (!named && (layer.scope == Scope::kSample || (layer.scope == Scope::kPass && !plain)))
      report.notes.push_back(layer.name + " is not written: these names have no place for it");
    if (!named) continue;
    for (uint32_t c = 0; c < layer.channel_count; ++c)
      plan.places.push_back(
          {layer, layer.first_channel + c, channel_name(layer, layer.components[c], names)});
  }
  plan.about = describe_dump(dump);
  if (plain) return plan;
  plan.about = {.texts = {{"spoolSource", source_of(plan.about)}}, .numbers = {}};
  if (names == ExrNames::kBlender)
    plan.about.texts.insert({{"BlenderMultiChannel", "spool"}, {"cycles.ViewLayer.samples", "1"}});
  return plan;
}

Result<void> write_images(const format::SpoolReader& dump, const FolderPlan& plan,
                          format::FileSet& set) {
  uint64_t sample_bytes = 0;
  for (const Place& place : plan.places)
    sample_bytes +=
        format::bytes_per_value(place.layer.type) * dump.header().width * dump.header().height;
  const auto step = static_cast<uint32_t>(std::max<uint64_t>(1, kImageBytes / sample_bytes));
  for (uint32_t block = 0; block < dump.blocks(); ++block) {
    for (uint32_t s0 = 0; s0 < dump.block_count(block); s0 += step) {
      auto images = blank_images(dump.header(), plan.about, plan.places,
                                 std::min(step, dump.block_count(block) - s0));
      SPOOL_TRY(fill_images(dump, plan.places, block, s0, images));
      for (uint32_t s = 0; s < images.size(); ++s) {
        for (const LayerInfo& layer : plan.pass_layers) {
          SPOOL_ASSIGN(auto texts, pass_attributes(dump, layer, block, s0 + s));
          images[s].attributes.texts.merge(texts);
        }
        SPOOL_TRY(set.write(
            sample_name(dump.block_begin(block) + s0 + s),
            [&](const std::filesystem::path& path) { return write_exr_planes(path, images[s]); }));
      }
    }
  }
  return {};
}

Result<ExportReport> export_exr_folder(const std::filesystem::path& in,
                                       const std::filesystem::path& out,
                                       const ExrFolderExportOptions& options) {
  SPOOL_ASSIGN(const format::SpoolReader dump, format::SpoolReader::open(in));
  SPOOL_TRY(require_complete(dump));
  std::error_code error;
  if (!options.force && std::filesystem::exists(out, error) &&
      !std::filesystem::is_empty(out, error))
    return fail(ErrorCode::kUsage,
                "{}: exists and is not empty: choose another name or use --force", out.string());
  std::filesystem::create_directories(out, error);
  if (error)
    return fail(ErrorCode::kIo, "{}: cannot be made ({}): check the path", out.string(),
                error.message());
  ExportReport report;
  const FolderPlan plan = plan_folder(dump, options.names, report);
  std::vector<std::string> names;
  if (plan.pixel_layers) names.emplace_back(kPixelFile);
  for (uint32_t s = 0; s < dump.header().spp; ++s)
    names.push_back(sample_name(s));
  SPOOL_TRY(add_earlier_images(out, names));
  SPOOL_ASSIGN(format::FileSet set,
               format::FileSet::create(out, std::move(names), options.force, {in}));
  SPOOL_TRY(write_images(dump, plan, set));
  if (plan.pixel_layers) {
    SPOOL_ASSIGN(ScratchLayers scratch, unpack_layers(dump, out / "pixel_layers"));
    SPOOL_TRY(set.write(kPixelFile, [&](const std::filesystem::path& path) {
      return write_pixel_layers(dump, scratch, path);
    }));
    report.notes.push_back("layers with one value per pixel are in pixel_layers.exr");
  }
  SPOOL_TRY(set.publish());
  return report;
}

}  // namespace

interchange::ExportFormat exr_folder_target() {
  using O = ExrFolderExportOptions;
  return interchange::export_format<O>(
      "exr-folder", "a folder with one EXR image per sample",
      {choice_option<O, ExrNames>(
          "names", &O::names,
          {{"plain", ExrNames::kPlain}, {"blender", ExrNames::kBlender}, {"rgb", ExrNames::kRgb}},
          "of channels; plain comes back as it was")},
      export_exr_folder);
}

}  // namespace spool::exchange
