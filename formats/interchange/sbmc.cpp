#include "formats/interchange/sbmc.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <fstream>

#include "formats/byte_io.h"
#include "formats/interchange/layer_names.h"
#include "formats/interchange/sbmc_tile.h"
#include "formats/temporary_file.h"

namespace spool::interchange {
namespace {

using format::FileHandle;
using format::load;
using format::Scope;
using format::store;
namespace plane = sbmc_plane;

// Distances were divided by ten times the scene's radius ("normalised") or not ("raw"). Without an
// answer it is taken from the light pdfs, which are logarithms in the first case.
enum class SbmcScale { kNormalised, kRaw };

struct SbmcImportOptions : ImportOptions {
  std::optional<SbmcScale> scale;
};

constexpr size_t kMaxListBytes = size_t{16} << 20;

Result<std::vector<std::filesystem::path>> tile_files(const std::filesystem::path& in) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  if (std::filesystem::is_directory(in, error)) {
    for (const auto& entry : std::filesystem::directory_iterator(in, error))
      if (entry.path().extension() == ".bin") files.push_back(entry.path());
  } else if (in.extension() == ".txt") {
    const auto bytes = std::filesystem::file_size(in, error);
    if (error) return fail(ErrorCode::kIo, "{}: cannot be read: check the path", in.string());
    if (bytes > kMaxListBytes)
      return fail(ErrorCode::kData, "{}: {} bytes: not a list of tiles", in.string(), bytes);
    std::ifstream list(in);
    for (std::string line; std::getline(list, line);)
      if (!line.empty()) files.push_back(in.parent_path() / line);
  } else {
    files.push_back(in);
  }
  if (error)
    return fail(ErrorCode::kIo, "{}: cannot be listed ({}): check the path", in.string(),
                error.message());
  if (files.empty())
    return fail(ErrorCode::kData, "{}: no *.bin in it: give the folder of one scene", in.string());
  std::sort(files.begin(), files.end());
  return files;
}

// Headers that agree, every place of the image once.
Result<SbmcHeader> check_set(const std::filesystem::path& in,
                             const std::vector<std::filesystem::path>& files) {
  SbmcHeader first;
  std::vector<bool> present;
  for (const std::filesystem::path& file : files) {
    SPOOL_ASSIGN(const SbmcTile tile, SbmcTile::open(file));
    const SbmcHeader& header = tile.header();
    const uint32_t columns = header.width / header.tile_size;
    if (present.empty()) {
      first = header;
      present.resize(size_t{columns} * (header.height / header.tile_size));
    }
    if (!header.same_set(first))
      return fail(ErrorCode::kData, "{}: its header differs from {}: they are not one set",
                  file.string(), files[0].filename().string());
    const size_t place =
        size_t{header.y / header.tile_size} * columns + header.x / header.tile_size;
    if (present[place])
      return fail(ErrorCode::kData, "{}: a second tile at {},{}: remove one", file.string(),
                  header.x, header.y);
    present[place] = true;
  }
  const auto missing = std::count(present.begin(), present.end(), false);
  if (missing > 0) {
    const auto at =
        static_cast<uint32_t>(std::find(present.begin(), present.end(), false) - present.begin());
    const uint32_t columns = first.width / first.tile_size;
    return fail(ErrorCode::kDamage,
                "{}: {} of {} tiles missing (first at {},{}): the renderer skips tiles that hold "
                "NaN; render them again",
                in.string(), missing, present.size(), at % columns * first.tile_size,
                at / columns * first.tile_size);
  }
  return first;
}

float value(std::span<const std::byte> frame, uint64_t pixels, uint32_t at, uint64_t pixel) {
  return load<float>(frame, 4 * (at * pixels + pixel));
}

// A negative pdf is a logarithm; an exact zero can only be a pdf itself.
Result<SbmcScale> find_scale(const std::filesystem::path& in,
                             const std::vector<std::filesystem::path>& files) {
  bool zero = false;
  for (const std::filesystem::path& file : files) {
    SPOOL_ASSIGN(SbmcTile tile, SbmcTile::open(file));
    const uint64_t pixels = tile.header().pixels();
    SPOOL_TRY(tile.next_frame());
    for (uint32_t s = 0; s < tile.header().spp; ++s) {
      SPOOL_ASSIGN(const auto frame, tile.next_frame());
      for (uint64_t i = 0; i < plane::kPdfCount * pixels; ++i) {
        const float pdf = value(frame, pixels, plane::kPdf, i);
        if (pdf < 0) return SbmcScale::kNormalised;
        zero = zero || pdf == 0;
      }
    }
  }
  if (zero) return SbmcScale::kRaw;
  return fail(ErrorCode::kUsage,
              "{}: unknown whether distances were divided by the scene's size: give "
              "--set import.scale=normalised or raw",
              in.string());
}

// One layer of the recording: which planes, and how their numbers change.
struct Row {
  const char* name;
  uint32_t plane;
  bool negate = false;
  bool distance = false;  // divided by ten scene radii in normalised files
};
constexpr Row kRows[] = {
    {"diffuse", plane::kDiffuse},
    {"film", plane::kFilm},
    {"lens", plane::kLens},
    {"time", plane::kTime},
    {"normal", plane::kNormalFirst, true},
    {"normal_ns", plane::kNormal, true},
    {"depth", plane::kDepthFirst, false, true},
    {"depth_ns", plane::kDepth, false, true},
    {"visibility", plane::kVisibility},
    {"hit", plane::kHit},
    {"albedo", plane::kAlbedoFirst},
    {"albedo_ns", plane::kAlbedo},
};

struct Laid {
  std::vector<ForeignLayer> layers;  // offsets in the scratch file
  uint64_t bytes = 0;

  ForeignLayer& add(const std::string& name, std::vector<std::string> components, Scope scope,
                    const SbmcHeader& header, ElementType type = ElementType::kFloat32) {
    ForeignLayer layer{name, std::move(components), scope, {}};
    layer.array.offset = bytes;
    layer.array.type = type;
    layer.array.sample_major = scope == Scope::kSample;
    layer.array.width = header.width;
    layer.array.height = header.height;
    layer.array.samples = scope == Scope::kSample ? header.spp : 1;
    layer.array.components = static_cast<uint32_t>(layer.components.size());
    bytes += layer.array.bytes();
    layers.push_back(std::move(layer));
    return layers.back();
  }
};

Laid lay_out(const SbmcHeader& header) {
  Laid laid;
  const std::vector<std::string> rgb = {"R", "G", "B"};
  laid.add("radiance", rgb, Scope::kSample, header);
  for (const Row& row : kRows) {
    if (row.plane == plane::kLens && header.aperture == 0) continue;  // a pinhole has no lens
    laid.add(row.name, find_layer_name(row.name)->components, Scope::kSample, header);
  }
  laid.add("path", {"flags"}, Scope::kSample, header, ElementType::kUint32);
  laid.add("reference", rgb, Scope::kPixel, header);
  laid.add("reference_diffuse_variance", rgb, Scope::kPixel, header);
  laid.add("reference_specular_variance", rgb, Scope::kPixel, header);
  return laid;
}

struct Decoder {
  const SbmcTile* tile = nullptr;
  uint64_t pixels = 0;
  float distance = 1;  // what distances are multiplied by
  float shift_x = 0, shift_y = 0;
  std::span<const std::byte> frame;

  float at(uint32_t which, uint64_t pixel) const { return value(frame, pixels, which, pixel); }

  // bits of component c of a layer at a pixel
  uint32_t bits(const ForeignLayer& layer, uint32_t c, uint64_t pixel) const {
    if (layer.name == "path") {
      uint32_t flags = 0;
      for (uint32_t v = 0; v < plane::kVertices; ++v)
        flags |=
            uint32_t{load<uint16_t>(frame, 4 * plane::kFlags * pixels + 2 * (v * pixels + pixel))}
            << (5 * v);
      return flags;
    }
    return std::bit_cast<uint32_t>(number(layer, c, pixel));
  }

 private:
  float number(const ForeignLayer& layer, uint32_t c, uint64_t pixel) const {
    if (layer.name == "radiance")
      return at(plane::kDiffuse + c, pixel) + at(plane::kSpecular + c, pixel);
    if (layer.name == "reference") return at(c, pixel) + at(plane::kImageSpecular + c, pixel);
    if (layer.name == "reference_diffuse_variance") return at(plane::kImageVariances + c, pixel);
    if (layer.name == "reference_specular_variance")
      return at(plane::kImageVariances + plane::kImageSpecular + c, pixel);
    const Row& row = *std::find_if(std::begin(kRows), std::end(kRows),
                                   [&](const Row& r) { return layer.name == r.name; });
    const float raw = at(row.plane + c, pixel);
    if (row.plane == plane::kFilm) return raw - (c == 0 ? shift_x : shift_y);
    // The scale of the lens planes and of the header's aperture is the same and cancels.
    if (row.plane == plane::kLens) return raw / tile->header().aperture;
    return (row.negate ? -raw : raw) * (row.distance ? distance : 1.0f);
  }
};

Result<void> check_frame(const Decoder& decoder, uint32_t sample) {
  const SbmcHeader& header = decoder.tile->header();
  for (uint64_t p = 0; p < decoder.pixels; ++p) {
    const float film[2] = {decoder.at(plane::kFilm, p) - decoder.shift_x,
                           decoder.at(plane::kFilm + 1, p) - decoder.shift_y};
    for (int c = 0; c < 2; ++c)
      if (!(film[c] >= 0 && film[c] <= 1))
        return fail(ErrorCode::kData,
                    "{}: sub-pixel {} {} outside [0,1] (pixel {},{} sample {}): the renderer's "
                    "windows did not match the tiles; unusable",
                    decoder.tile->file().path().string(), c == 0 ? 'x' : 'y', film[c],
                    header.x + p % header.tile_size, header.y + p / header.tile_size, sample);
    for (uint32_t v = 0; v < plane::kVertices; ++v) {
      const auto flags = load<uint16_t>(
          decoder.frame, 4 * plane::kFlags * decoder.pixels + 2 * (v * decoder.pixels + p));
      if (flags >= 32)
        return fail(ErrorCode::kDamage,
                    "{}: bounce flags {} of vertex {} (pixel {},{} sample {}): the file is damaged",
                    decoder.tile->file().path().string(), flags, v, header.x + p % header.tile_size,
                    header.y + p / header.tile_size, sample);
    }
  }
  return {};
}

// The frame's part of a layer, row by row into the scratch file.
Result<void> put(const Decoder& decoder, const ForeignLayer& layer, uint64_t sample,
                 FileHandle& scratch) {
  const SbmcHeader& header = decoder.tile->header();
  const uint64_t channels = layer.array.components;
  std::vector<std::byte> row(4 * header.tile_size * channels);
  for (uint64_t y = 0; y < header.tile_size; ++y) {
    for (uint64_t x = 0; x < header.tile_size; ++x)
      for (uint32_t c = 0; c < channels; ++c)
        store(std::span(row), 4 * (x * channels + c),
              decoder.bits(layer, c, y * header.tile_size + x));
    const uint64_t pixel = (sample * header.height + header.y + y) * header.width + header.x;
    SPOOL_TRY(scratch.write_at(layer.array.offset + 4 * channels * pixel, row));
  }
  return {};
}

// A crop window moves all sub-pixel positions of a tile by whole pixels: what its name says.
std::optional<std::pair<int32_t, int32_t>> place_in_name(const std::string& stem) {
  std::pair<int32_t, int32_t> place;
  const char* end = stem.data() + stem.size();
  const auto x = std::from_chars(stem.data(), end, place.first);
  if (x.ec != std::errc() || x.ptr == end || *x.ptr != '_') return std::nullopt;
  const auto y = std::from_chars(x.ptr + 1, end, place.second);
  if (y.ec != std::errc() || y.ptr != end) return std::nullopt;
  return place;
}

Result<ForeignFile> unpack_tile(const std::filesystem::path& path, float distance, const Laid& laid,
                                FileHandle& scratch) {
  SPOOL_ASSIGN(SbmcTile tile, SbmcTile::open(path));
  Decoder decoder{&tile, tile.header().pixels(), distance, 0, 0, {}};
  if (const auto place = place_in_name(path.stem().string())) {
    decoder.shift_x = static_cast<float>(place->first) - static_cast<float>(tile.header().x);
    decoder.shift_y = static_cast<float>(place->second) - static_cast<float>(tile.header().y);
  }
  for (uint32_t f = 0; f <= tile.header().spp; ++f) {
    SPOOL_ASSIGN(const auto frame, tile.next_frame());
    decoder.frame = frame;
    if (f > 0) SPOOL_TRY(check_frame(decoder, f - 1));
    for (const ForeignLayer& layer : laid.layers)
      if ((layer.scope == Scope::kPixel) == (f == 0))
        SPOOL_TRY(put(decoder, layer, f == 0 ? 0 : f - 1, scratch));
  }
  SPOOL_TRY(tile.finish());
  return identify(tile.file());
}

void describe(const SbmcHeader& header, float scale, DumpPlan& plan) {
  plan.meta["camera"] = {{"focus_distance", std::isfinite(header.focus) ? header.focus * scale : 0},
                         {"aperture_radius", header.aperture * scale},
                         {"fov", header.fov * 100},
                         {"scene_radius", header.radius}};
  plan.meta["reference"] = {{"samples_per_pixel", header.reference_spp}};
  for (const char* layer : {"normal", "normal_ns"})
    plan.meta["channels"][layer] = {{"space", "camera"}};
  plan.record.converted = {"radiance: diffuse + specular", "normal, normal_ns: sign turned",
                           "depth, depth_ns: times the scene's scale",
                           "lens: divided by the aperture", "path.flags: six vertices of 5 bits"};
  plan.record.dropped = {"light and BSDF pdfs", "light angles", "variances of features"};
}

Result<ImportReport> import_sbmc(const std::filesystem::path& in, const std::filesystem::path& out,
                                 const SbmcImportOptions& options) {
  SPOOL_TRY(format::refuse_existing_target(out, options.force));
  SPOOL_ASSIGN(const auto files, tile_files(in));
  SPOOL_ASSIGN(const SbmcHeader header, check_set(in, files));
  SbmcScale scale = options.scale.value_or(SbmcScale::kRaw);
  if (!options.scale) {
    SPOOL_ASSIGN(scale, find_scale(in, files));
  }
  const bool scaled = scale == SbmcScale::kNormalised && header.radius > 0;
  const float distance = scaled ? 10.0f * header.radius : 1.0f;
  Laid laid = lay_out(header);
  uint64_t source_bytes = 0;
  std::error_code unreadable;
  for (const auto& file : files)
    source_bytes += std::filesystem::file_size(file, unreadable);
  SPOOL_TRY(options.expansion.check(in.string(), stored_bytes(laid.layers), source_bytes));
  SPOOL_ASSIGN(FileHandle scratch, format::open_scratch_file(out));
  DumpPlan plan;
  for (const std::filesystem::path& file : files) {
    SPOOL_ASSIGN(ForeignFile identity, unpack_tile(file, distance, laid, scratch));
    plan.record.files.push_back(std::move(identity));
  }
  plan.width = header.width;
  plan.height = header.height;
  plan.spp = header.spp;
  plan.sample_order = format::SampleOrder::kExchangeable;
  plan.layers = std::move(laid.layers);
  for (ForeignLayer& layer : plan.layers)
    layer.array.file = &scratch;
  plan.record.format = "sbmc";
  plan.record.version = header.version;
  plan.record.options = {{"scale", scale == SbmcScale::kRaw ? "raw" : "normalised"}};
  plan.record.independent = "false";
  describe(header, distance, plan);
  const std::vector<std::string> dropped = plan.record.dropped;
  SPOOL_ASSIGN(ImportReport report, write_dump(out, std::move(plan), options));
  for (const std::string& what : dropped)
    report.notes.push_back(what + " were not taken over");
  report.notes.push_back(
      "the samples of a pixel are stratified: their variance overestimates that of the mean");
  return report;
}

}  // namespace

ImportFormat sbmc_format() {
  using O = SbmcImportOptions;
  return import_format<O>(
      "sbmc", "a folder of *.bin tiles, or a .txt that lists them",
      {open_choice_option<O, SbmcScale>(
          "scale", &O::scale, "auto",
          {{"normalised", SbmcScale::kNormalised}, {"raw", SbmcScale::kRaw}},
          "whether distances were divided by the scene's size; auto: by the light pdfs")},
      import_sbmc);
}

}  // namespace spool::interchange
