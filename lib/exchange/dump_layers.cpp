#include "lib/exchange/dump_layers.h"

#include <algorithm>

#include "formats/bounded_json.h"
#include "formats/interchange/export_file.h"
#include "formats/temporary_file.h"
#include "lib/core/visible_text.h"

namespace spool::exchange {

using format::LayerInfo;
using format::Scope;
using nlohmann::json;

namespace {

constexpr std::array<std::string_view, 3> kScopes = {"sample", "pixel", "pass"};
constexpr std::array<std::string_view, 4> kTypes = {"", "f16", "f32", "u32"};

uint64_t values_of(const LayerInfo& layer, const format::DumpHeader& header) {
  const uint64_t pixels = uint64_t{header.width} * header.height;
  return (layer.scope == Scope::kPass ? 1 : pixels) *
         (layer.scope == Scope::kPixel ? 1 : header.spp) * layer.channel_count;
}

}  // namespace

PixelType pixel_type(format::DataType type) {
  return type == format::DataType::kFloat16   ? PixelType::kHalf
         : type == format::DataType::kFloat32 ? PixelType::kFloat
                                              : PixelType::kUint;
}

interchange::ElementType element_type(PixelType type) {
  return type == PixelType::kHalf    ? interchange::ElementType::kFloat16
         : type == PixelType::kFloat ? interchange::ElementType::kFloat32
                                     : interchange::ElementType::kUint32;
}

Result<void> require_complete(const format::SpoolReader& dump) {
  if (dump.complete()) return {};
  return fail(ErrorCode::kData, "{}: blocks are missing: an image has no place for holes",
              dump.path().string());
}

Result<ScratchLayers> unpack_layers(const format::SpoolReader& dump,
                                    const std::filesystem::path& out) {
  ScratchLayers scratch;
  SPOOL_ASSIGN(scratch.file, format::open_scratch_file(out));
  uint64_t end = 0;
  for (const LayerInfo& layer : dump.layers()) {
    SPOOL_TRY(interchange::write_layer(dump, layer, layer.type, end, scratch.file));
    scratch.layers.push_back({layer, end});
    end += values_of(layer, dump.header()) * format::bytes_per_value(layer.type);
  }
  return scratch;
}

ExrAttributes describe_dump(const format::SpoolReader& dump) {
  ExrAttributes attributes;
  json channels = json::array();
  for (const format::ChannelInfo& channel : dump.header().channels)
    channels.push_back({{"name", channel.name},
                        {"group", channel.group},
                        {"dtype", kTypes[static_cast<size_t>(channel.type)]},
                        {"semantic", channel.semantic},
                        {"scope", kScopes[static_cast<size_t>(channel.scope)]}});
  json meta = json::object();
  for (const std::string& text : dump.meta())
    meta.update(format::parse_json(text));
  std::string uuid;
  for (const uint8_t byte : dump.header().uuid)
    uuid += fmt::format("{:02x}", byte);
  const bool exchangeable = dump.header().sample_order == format::SampleOrder::kExchangeable;
  attributes.numbers = {{"spoolVersion", 1.0}, {"samplesPerPixel", dump.header().spp}};
  attributes.texts = {{"spoolChannels", channels.dump()},
                      {"spoolMeta", meta.dump(-1, ' ', false, json::error_handler_t::replace)},
                      {"spoolSampleOrder", exchangeable ? "exchangeable" : "renderer"},
                      {"spoolPixelFilter", "box"},
                      {"spoolSource", uuid}};
  return attributes;
}

Result<std::optional<ToldDump>> told_dump(const ExrAttributes& attributes,
                                          const std::string& name) {
  const auto version = attributes.numbers.find("spoolVersion");
  if (version == attributes.numbers.end()) return std::nullopt;
  if (version->second != 1.0)
    return fail(ErrorCode::kData, "{}: spoolVersion {}: read it with a newer spool", name,
                version->second);
  const auto text = [&](const char* key) {
    const auto found = attributes.texts.find(key);
    return found == attributes.texts.end() ? std::string() : found->second;
  };
  ToldDump told;
  const json channels = format::parse_json(text("spoolChannels"), format::kMaxMetaBytes);
  const json meta = format::parse_json(text("spoolMeta"), format::kMaxMetaBytes);
  const auto refuse = [&](std::string_view what) {
    return fail(ErrorCode::kData, "{}: attribute {} makes no sense: was it edited?", name, what);
  };
  if (!channels.is_array() || channels.empty() || channels.size() > format::kMaxChannels)
    return refuse("spoolChannels");
  for (const json& channel : channels) {
    if (!channel.is_object()) return refuse("spoolChannels");
    const json given = channel.value("name", json()), scope = channel.value("scope", json());
    const auto known = std::find(kScopes.begin(), kScopes.end(),
                                 scope.is_string() ? scope.get<std::string>() : "");
    if (!given.is_string() || known == kScopes.end()) return refuse("spoolChannels");
    auto [layer, component] = split_channel(given.get<std::string>());
    if (layer.empty() || component.empty() ||
        printable_ascii(layer + component) != layer + component)
      return refuse("spoolChannels");
    told.channels.push_back(
        {std::move(layer), std::move(component), static_cast<Scope>(known - kScopes.begin())});
  }
  if (!meta.is_object()) return refuse("spoolMeta");
  told.meta = meta;
  told.meta.erase("import");
  if (text("spoolSampleOrder") == "exchangeable")
    told.sample_order = format::SampleOrder::kExchangeable;
  else if (text("spoolSampleOrder") != "renderer")
    return refuse("spoolSampleOrder");
  if (const auto found = attributes.numbers.find("samplesPerPixel");
      found != attributes.numbers.end())
    told.samples = found->second;
  return told;
}

bool ToldDump::has_pixel_layers() const {
  return std::ranges::any_of(channels,
                             [](const ToldChannel& c) { return c.scope == Scope::kPixel; });
}

Result<void> write_pixel_layers(const format::SpoolReader& dump, ScratchLayers& scratch,
                                const std::filesystem::path& path, bool force) {
  ExrPlanes image;
  image.width = static_cast<int>(dump.header().width);
  image.height = static_cast<int>(dump.header().height);
  const uint64_t pixels = uint64_t{dump.header().width} * dump.header().height;
  for (const ScratchLayer& stored : scratch.layers) {
    if (stored.layer.scope != Scope::kPixel) continue;
    const uint64_t channels = stored.layer.channel_count;
    const uint64_t bytes = format::bytes_per_value(stored.layer.type);
    std::vector<std::byte> values(pixels * channels * bytes);
    SPOOL_TRY(scratch.file.read_at(stored.offset, values));
    for (uint64_t c = 0; c < channels; ++c) {
      ExrPlane plane{stored.layer.name + "." + stored.layer.components[c],
                     pixel_type(stored.layer.type), std::vector<std::byte>(pixels * bytes)};
      for (uint64_t p = 0; p < pixels; ++p)
        std::copy_n(values.begin() + static_cast<ptrdiff_t>((p * channels + c) * bytes), bytes,
                    plane.values.begin() + static_cast<ptrdiff_t>(p * bytes));
      image.planes.push_back(std::move(plane));
    }
  }
  if (image.planes.empty()) return {};
  return write_exr_planes(path, image, {.overwrite = force});
}

Result<void> read_pixel_layers(const std::filesystem::path& path, uint64_t& end,
                               format::FileHandle& scratch, interchange::DumpPlan& plan) {
  SPOOL_ASSIGN(ExrPlanes image, read_exr_planes(path));
  if (image.width != static_cast<int>(plan.width) || image.height != static_cast<int>(plan.height))
    return fail(ErrorCode::kData, "{}: {} x {} pixels, the samples have {} x {}: save them alike",
                path.string(), image.width, image.height, plan.width, plan.height);
  const auto component_order = [](const ExrPlane& plane) {
    const auto [layer, component] = split_channel(plane.name);
    const size_t colour = std::string_view("RGB").find(component);
    return std::pair(layer, colour == std::string::npos ? component : fmt::format("{}", colour));
  };
  std::stable_sort(image.planes.begin(), image.planes.end(),
                   [&](const ExrPlane& a, const ExrPlane& b) {
                     return component_order(a) < component_order(b);
                   });
  const uint64_t pixels = uint64_t{plan.width} * plan.height;
  for (size_t first = 0; first < image.planes.size();) {
    const auto [layer_name, ignored] = split_channel(image.planes[first].name);
    interchange::ForeignLayer layer{layer_name, {}, Scope::kPixel, {}};
    size_t last = first;
    while (last < image.planes.size() &&
           split_channel(image.planes[last].name).first == layer_name &&
           image.planes[last].type == image.planes[first].type)
      layer.components.push_back(split_channel(image.planes[last++].name).second);
    if (layer_name.empty())
      return fail(ErrorCode::kData, "{}: channel {} has no layer: name it LAYER.COMPONENT",
                  path.string(), printable_ascii(image.planes[first].name));
    const size_t bytes = bytes_per_value(image.planes[first].type);
    const size_t channels = last - first;
    std::vector<std::byte> values(pixels * channels * bytes);
    for (size_t c = 0; c < channels; ++c)
      for (uint64_t p = 0; p < pixels; ++p)
        std::copy_n(image.planes[first + c].values.begin() + static_cast<ptrdiff_t>(p * bytes),
                    bytes, values.begin() + static_cast<ptrdiff_t>((p * channels + c) * bytes));
    SPOOL_TRY(scratch.write_at(end, values));
    layer.array.offset = end;
    layer.array.type = element_type(image.planes[first].type);
    layer.array.width = plan.width;
    layer.array.height = plan.height;
    layer.array.components = static_cast<uint32_t>(channels);
    end += values.size();
    plan.layers.push_back(std::move(layer));
    first = last;
  }
  SPOOL_ASSIGN(const auto file, format::FileHandle::open(path, format::OpenMode::kRead));
  SPOOL_ASSIGN(interchange::ForeignFile identity, interchange::identify(file));
  plan.record.files.push_back(std::move(identity));
  return {};
}

Result<void> read_told_pixel_layers(const ToldDump& told, const std::filesystem::path& path,
                                    uint64_t& end, format::FileHandle& scratch,
                                    interchange::DumpPlan& plan) {
  std::error_code unknown;
  if (!std::filesystem::exists(path, unknown))
    return fail(ErrorCode::kData,
                "{}: is missing, the recording had layers with one value per pixel: copy it "
                "beside the samples, or export again",
                path.string());
  SPOOL_TRY(read_pixel_layers(path, end, scratch, plan));
  for (const ToldChannel& channel : told.channels) {
    const auto is_it = [&](const interchange::ForeignLayer& layer) {
      return layer.scope == Scope::kPixel && layer.name == channel.layer &&
             std::ranges::find(layer.components, channel.component) != layer.components.end();
    };
    if (channel.scope == Scope::kPixel && std::ranges::none_of(plan.layers, is_it))
      return fail(ErrorCode::kData, "{}: no channel {}: was it dropped by a tool?", path.string(),
                  channel.name());
  }
  return {};
}

}  // namespace spool::exchange
