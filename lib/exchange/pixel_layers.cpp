#include "lib/exchange/pixel_layers.h"

#include <algorithm>
#include <span>
#include <tuple>

#include "lib/core/visible_text.h"

namespace spool::exchange {

using format::Scope;

std::string lossy_remark(const std::string& compression, size_t images, size_t all) {
  return fmt::format(
      "{} is a compression with loss: the values of {} of {} images are near those that were "
      "rendered",
      compression, images, all);
}

Result<void> write_pixel_layers(const format::SpoolReader& dump, ScratchLayers& scratch,
                                const std::filesystem::path& path) {
  ExrPlanes image;
  image.width = static_cast<int>(dump.header().width);
  image.height = static_cast<int>(dump.header().height);
  image.attributes.texts["spoolSource"] = source_of(describe_dump(dump));
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
  return write_exr_planes(path, image);
}

namespace {

// Planes in the order of the recording, and those that it had not after them, by name.
void put_in_order(const std::vector<ToldChannel>& told, std::vector<ExrPlane>& planes) {
  const auto place = [&](const ExrPlane& plane) {
    const auto [layer, component] = split_channel(plane.name);
    const size_t colour = std::string_view("RGB").find(component);
    return std::tuple(std::ranges::find(told, plane.name, &ToldChannel::name) - told.begin(), layer,
                      colour == std::string::npos ? component : fmt::format("{}", colour));
  };
  std::ranges::stable_sort(planes, {}, place);
}

Result<void> check_pixel_file(const ExrPlanes& image, const std::optional<ToldDump>& told,
                              const std::string& source, const interchange::DumpPlan& plan,
                              const std::string& name) {
  if (image.width != static_cast<int>(plan.width) || image.height != static_cast<int>(plan.height))
    return fail(ErrorCode::kData, "{}: {} x {} pixels, the samples have {} x {}: save them alike",
                name, image.width, image.height, plan.width, plan.height);
  const std::string own = source_of(image.attributes);  // an older export has none here
  if (!own.empty() && !source.empty() && own != source)
    return fail(ErrorCode::kData,
                "{}: of another recording than the samples: export both anew, each to a name of "
                "its own",
                name);
  if (!told) return {};
  for (const ToldChannel& channel : told->channels)
    if (channel.scope == Scope::kPixel &&
        std::ranges::find(image.planes, channel.name(), &ExrPlane::name) == image.planes.end())
      return fail(ErrorCode::kData, "{}: no channel {}: was it dropped by a tool?", name,
                  channel.name());
  return {};
}

}  // namespace

Result<void> read_pixel_layers(const std::optional<ToldDump>& told, const std::string& source,
                               const std::filesystem::path& path, uint64_t& end,
                               format::FileHandle& scratch, interchange::DumpPlan& plan) {
  std::error_code unknown;
  if (!std::filesystem::exists(path, unknown))
    return fail(ErrorCode::kData,
                "{}: is missing, the recording had layers with one value per pixel: copy it "
                "beside the samples, or export again",
                path.string());
  SPOOL_ASSIGN(ExrPlanes image, read_exr_planes(path));
  SPOOL_TRY(check_pixel_file(image, told, source, plan, path.string()));
  if (!image.lossy.empty()) plan.record.converted.push_back(lossy_remark(image.lossy, 1, 1));
  put_in_order(told ? told->channels : std::vector<ToldChannel>(), image.planes);
  for (size_t first = 0; first < image.planes.size();) {
    const auto [layer_name, ignored] = split_channel(image.planes[first].name);
    if (layer_name.empty())
      return fail(ErrorCode::kData, "{}: channel {} has no layer: name it LAYER.COMPONENT",
                  path.string(), printable_ascii(image.planes[first].name));
    interchange::ForeignLayer layer{layer_name, {}, Scope::kPixel, {}};
    size_t last = first;
    while (last < image.planes.size() &&
           split_channel(image.planes[last].name).first == layer_name &&
           image.planes[last].type == image.planes[first].type)
      layer.components.push_back(split_channel(image.planes[last++].name).second);
    if (told) layer.semantics = told->semantics(layer_name);
    layer.semantics.resize(layer.semantics.empty() ? 0 : layer.components.size());
    const auto values =
        interleaved(std::span(image.planes).subspan(first, last - first), image.planes[first].type);
    SPOOL_TRY(scratch.write_at(end, values));
    layer.array.offset = end;
    layer.array.type = element_type(image.planes[first].type);
    layer.array.width = plan.width;
    layer.array.height = plan.height;
    layer.array.components = static_cast<uint32_t>(last - first);
    end += values.size();
    plan.layers.push_back(std::move(layer));
    first = last;
  }
  SPOOL_ASSIGN(const auto file, format::FileHandle::open(path, format::OpenMode::kRead));
  SPOOL_ASSIGN(interchange::ForeignFile identity, interchange::identify(file));
  plan.record.files.push_back(std::move(identity));
  return {};
}

}  // namespace spool::exchange
