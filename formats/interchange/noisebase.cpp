#include "formats/interchange/noisebase.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "formats/byte_io.h"
#include "formats/checked_math.h"
#include "formats/interchange/layer_names.h"
#include "formats/interchange/npz_members.h"
#include "formats/interchange/zarr_array.h"
#include "formats/temporary_file.h"

namespace spool::interchange {
namespace {

using format::FileHandle;
using format::load;
using format::Scope;
using format::store;
using nlohmann::json;

struct NoisebaseImportOptions : ImportOptions {
  std::optional<uint64_t> frame;  // of a sequence
};

constexpr uint64_t kMaxMetaValues = 64;

struct Source {
  const char* theirs;
  const char* ours;
  const char* type;
  uint64_t components;
  bool per_sample;
};
constexpr Source kSources[] = {
    {"color", "radiance", "|u1", 4, true}, {"position", "position", "<f4", 3, true},
    {"motion", "motion", "<f4", 3, true},  {"normal", "normal", "<f2", 3, true},
    {"diffuse", "albedo", "<f2", 3, true}, {"reference", "reference", "<f4", 3, false},
};
constexpr const char* kMetaArrays[] = {"camera_position", "camera_target", "camera_up",
                                       "view_proj_mat",   "proj_mat",      "crop_offset"};

// An array, and the frame of it that is taken: axis 0 of a sequence.
struct Taken {
  ZarrArray array;
  bool sequence = false;
  uint64_t frame = 0;

  uint64_t axis(size_t i) const { return array.shape[i + (sequence ? 1 : 0)]; }
  uint64_t chunk_axis(size_t i) const { return array.chunks[i + (sequence ? 1 : 0)]; }
  size_t axes() const { return array.shape.size() - (sequence ? 1 : 0); }
};

Result<Taken> take(const ZarrZip& zip, const std::string& name, size_t axes,
                   std::optional<uint64_t> frame) {
  const std::string file = zip.file().path().string();
  Taken taken;
  SPOOL_ASSIGN(taken.array, zip.array(name));
  if (taken.array.shape.size() == axes) return taken;
  if (taken.array.shape.size() != axes + 1)
    return fail(ErrorCode::kData, "{}: {} is {} {}: not a Noisebase sample set", file, name,
                taken.array.type, shape_text(taken.array.shape));
  if (!frame)
    return fail(ErrorCode::kUsage,
                "{}: a sequence of {} frames: choose one with --set import.frame=N", file,
                taken.array.shape[0]);
  if (*frame >= taken.array.shape[0])
    return fail(ErrorCode::kUsage, "{}: {} has {} frames, no frame {}: choose another", file, name,
                taken.array.shape[0], *frame);
  taken.sequence = true;
  taken.frame = *frame;
  return taken;
}

// The chunk at `place` (without the axis of frames), and where the wanted frame begins in it.
Result<std::vector<std::byte>> read_chunk(const ZarrZip& zip, const Taken& taken,
                                          std::vector<uint64_t> place) {
  uint64_t skipped = 0;
  if (taken.sequence) {
    place.insert(place.begin(), taken.frame / taken.array.chunks[0]);
    skipped = taken.frame % taken.array.chunks[0];
  }
  SPOOL_ASSIGN(auto bytes, zip.chunk(taken.array, place));
  if (!taken.sequence) return bytes;
  const size_t one = bytes.size() / taken.array.chunks[0];
  return std::vector<std::byte>(bytes.begin() + static_cast<ptrdiff_t>(skipped * one),
                                bytes.begin() + static_cast<ptrdiff_t>((skipped + 1) * one));
}

// A small array as JSON numbers.
Result<json> small_array(const ZarrZip& zip, const std::string& name, size_t axes,
                         std::optional<uint64_t> frame) {
  SPOOL_ASSIGN(const Taken taken, take(zip, name, axes, frame));
  const std::string file = zip.file().path().string();
  uint64_t values = 1;
  for (size_t i = 0; i < axes; ++i) {
    values *= std::min<uint64_t>(taken.axis(i), kMaxMetaValues + 1);
    if (taken.chunk_axis(i) != taken.axis(i) || values > kMaxMetaValues)
      return fail(ErrorCode::kData, "{}: {} is {} in chunks {}: not a Noisebase sample set", file,
                  name, shape_text(taken.array.shape), shape_text(taken.array.chunks));
  }
  SPOOL_ASSIGN(const auto bytes, read_chunk(zip, taken, std::vector<uint64_t>(axes, 0)));
  json list = json::array();
  for (uint64_t i = 0; i < values; ++i) {
    if (taken.array.type == "<f4")
      list.push_back(load<float>(bytes, 4 * i));
    else if (taken.array.type == "<i4")
      list.push_back(load<int32_t>(bytes, 4 * i));
    else
      return fail(ErrorCode::kData, "{}: {} is {}: not a Noisebase sample set", file, name,
                  taken.array.type);
  }
  return list;
}

struct Size {
  uint64_t width = 0, height = 0, spp = 0;
};

Result<void> check_shape(const std::string& file, const Source& source, const Taken& taken,
                         const Size& size) {
  const std::string shape = shape_text(taken.array.shape);
  if (taken.array.type != source.type || taken.axis(0) != source.components)
    return fail(ErrorCode::kData, "{}: {} is {} {}: expected {} with {} components", file,
                source.theirs, taken.array.type, shape, source.type, source.components);
  if (taken.axis(1) != size.height || taken.axis(2) != size.width ||
      (source.per_sample && taken.axis(3) != size.spp))
    return fail(ErrorCode::kData, "{}: array {} is {} but color is {}x{} with {} samples", file,
                source.theirs, shape, size.width, size.height, size.spp);
  if (taken.chunk_axis(0) < source.components)
    return fail(ErrorCode::kData, "{}: {}: a chunk holds {} of {} components: store them together",
                file, source.theirs, taken.chunk_axis(0), source.components);
  return {};
}

// Linear R, G, B of one stored sample; `exposure`: lowest and highest natural logarithm.
std::array<float, 3> decode_rgbe(std::array<uint8_t, 4> rgbe, std::array<float, 2> exposure) {
  const float step = (static_cast<float>(rgbe[3]) + 1.0f) / 256.0f;
  const float scale = std::exp(exposure[0] + step * (exposure[1] - exposure[0]));
  std::array<float, 3> rgb{};
  for (size_t c = 0; c < 3; ++c)
    rgb[c] = static_cast<float>(rgbe[c]) / 255.0f * scale;
  return rgb;
}

// One chunk into the scratch file, as rows of [s][y][x][c].
Result<void> put_chunk(const Source& source, const Taken& taken, std::span<const std::byte> chunk,
                       const std::array<uint64_t, 3>& begin, const Size& size,
                       std::array<float, 2> exposure, uint64_t offset, FileHandle& scratch) {
  const bool colour = std::strcmp(source.theirs, "color") == 0;
  const uint64_t item = taken.array.item_bytes();
  const uint64_t rows = taken.chunk_axis(1), columns = taken.chunk_axis(2);
  const uint64_t samples = source.per_sample ? taken.chunk_axis(3) : 1;
  const uint64_t y1 = std::min(size.height, begin[0] + rows);
  const uint64_t x1 = std::min(size.width, begin[1] + columns);
  const uint64_t s1 = std::min(source.per_sample ? size.spp : 1, begin[2] + samples);
  const uint64_t pixel_bytes = 3 * (colour ? 4 : item);
  std::vector<std::byte> row((x1 - begin[1]) * pixel_bytes);
  for (uint64_t s = begin[2]; s < s1; ++s) {
    for (uint64_t y = begin[0]; y < y1; ++y) {
      const auto at = [&](uint64_t c, uint64_t x) {
        return ((c * rows + y - begin[0]) * columns + x - begin[1]) * samples + s - begin[2];
      };
      for (uint64_t x = begin[1]; x < x1; ++x) {
        const uint64_t to = (x - begin[1]) * pixel_bytes;
        if (colour) {
          std::array<uint8_t, 4> rgbe{};
          for (uint64_t c = 0; c < 4; ++c)
            rgbe[c] = load<uint8_t>(chunk, at(c, x));
          const auto rgb = decode_rgbe(rgbe, exposure);
          for (uint64_t c = 0; c < 3; ++c)
            store(std::span(row), to + 4 * c, rgb[c]);
        } else {
          for (uint64_t c = 0; c < 3; ++c)
            std::memcpy(&row[to + c * item], &chunk[at(c, x) * item], item);
        }
      }
      const uint64_t pixel = (s * size.height + y) * size.width + begin[1];
      SPOOL_TRY(scratch.write_at(offset + pixel * pixel_bytes, row));
    }
  }
  return {};
}

Result<void> unpack(const ZarrZip& zip, const Source& source, const Taken& taken, const Size& size,
                    std::array<float, 2> exposure, uint64_t offset, FileHandle& scratch) {
  const uint64_t step_s = source.per_sample ? taken.chunk_axis(3) : 1;
  for (uint64_t y = 0; y < size.height; y += taken.chunk_axis(1))
    for (uint64_t x = 0; x < size.width; x += taken.chunk_axis(2))
      for (uint64_t s = 0; s < (source.per_sample ? size.spp : 1); s += step_s) {
        std::vector<uint64_t> place = {0, y / taken.chunk_axis(1), x / taken.chunk_axis(2)};
        if (source.per_sample) place.push_back(s / step_s);
        SPOOL_ASSIGN(const auto chunk, read_chunk(zip, taken, std::move(place)));
        SPOOL_TRY(put_chunk(source, taken, chunk, {y, x, s}, size, exposure, offset, scratch));
      }
  return {};
}

Result<std::array<float, 2>> read_exposure(const ZarrZip& zip, std::optional<uint64_t> frame) {
  const std::string file = zip.file().path().string();
  SPOOL_ASSIGN(const json list, small_array(zip, "exposure", 1, frame));
  if (list.size() != 2 || !list[0].is_number_float())
    return fail(ErrorCode::kData, "{}: exposure is not two floats: not a Noisebase sample set",
                file);
  const std::array<float, 2> exposure = {list[0].get<float>(), list[1].get<float>()};
  // Natural logarithms; what a float does not hold would become infinite.
  if (!std::isfinite(exposure[0]) || !std::isfinite(std::exp(exposure[1])))
    return fail(ErrorCode::kDamage, "{}: exposure is {} to {}: the file is damaged", file,
                exposure[0], exposure[1]);
  if (exposure[1] < exposure[0])
    return fail(ErrorCode::kData, "{}: exposure hi < lo: the file is damaged or another format",
                file);
  return exposure;
}

ForeignLayer layer_of(const Source& source, const Size& size, uint64_t offset,
                      const FileHandle& scratch) {
  ForeignLayer layer{source.ours,
                     find_layer_name(source.ours)->components,
                     source.per_sample ? Scope::kSample : Scope::kPixel,
                     {}};
  layer.array.file = &scratch;
  layer.array.offset = offset;
  layer.array.type =
      std::strcmp(source.type, "<f2") == 0 ? ElementType::kFloat16 : ElementType::kFloat32;
  layer.array.sample_major = source.per_sample;
  layer.array.width = static_cast<uint32_t>(size.width);
  layer.array.height = static_cast<uint32_t>(size.height);
  layer.array.samples = source.per_sample ? static_cast<uint32_t>(size.spp) : 1;
  layer.array.components = 3;
  return layer;
}

// The arrays that become layers, which together may not be larger than is allowed: neither what
// is decoded nor what is laid out.
Result<std::vector<std::pair<Source, Taken>>> take_sources(const ZarrZip& zip, const Size& size,
                                                           const NoisebaseImportOptions& options) {
  const std::string name = zip.file().path().string();
  std::vector<std::pair<Source, Taken>> sources;
  std::optional<uint64_t> bytes = 0;
  for (const Source& source : kSources) {
    if (!zip.has(source.theirs)) continue;
    SPOOL_ASSIGN(Taken taken, take(zip, source.theirs, source.per_sample ? 4 : 3, options.frame));
    SPOOL_TRY(check_shape(name, source, taken, size));
    const auto decoded = taken.array.decoded_bytes(taken.sequence);
    const uint64_t laid_out =
        uint64_t{12} * size.width * size.height * (source.per_sample ? size.spp : 1);
    bytes =
        bytes && decoded ? format::checked_add(*bytes, std::max(*decoded, laid_out)) : std::nullopt;
    sources.emplace_back(source, std::move(taken));
  }
  SPOOL_TRY(options.expansion.check(name, bytes, zip.file_bytes()));
  return sources;
}

Result<ImportReport> import_noisebase(const std::filesystem::path& in,
                                      const std::filesystem::path& out,
                                      const NoisebaseImportOptions& options) {
  SPOOL_TRY(format::refuse_existing_target(out, options.force));
  SPOOL_ASSIGN(const ZarrZip zip, ZarrZip::open(in, options.expansion));
  const std::string name = in.string();
  if (!zip.has("color") || !zip.has("exposure"))
    return fail(ErrorCode::kData, "{}: no arrays color and exposure: not a Noisebase sample set",
                name);
  SPOOL_ASSIGN(const Taken colour, take(zip, "color", 4, options.frame));
  const Size size = {colour.axis(2), colour.axis(1), colour.axis(3)};
  if (size.width > format::kMaxSide || size.height > format::kMaxSide ||
      size.width * size.height > format::kMaxPixels || size.spp > format::kMaxSpp)
    return fail(ErrorCode::kData, "{}: color is {}: larger than a .spool holds", name,
                shape_text(colour.array.shape));
  SPOOL_ASSIGN(const auto exposure, read_exposure(zip, options.frame));
  SPOOL_ASSIGN(const auto sources, take_sources(zip, size, options));
  SPOOL_ASSIGN(FileHandle scratch, format::open_scratch_file(out));
  DumpPlan plan;
  uint64_t offset = 0;
  for (const auto& [source, taken] : sources) {
    SPOOL_TRY(unpack(zip, source, taken, size, exposure, offset, scratch));
    plan.layers.push_back(layer_of(source, size, offset, scratch));
    offset += uint64_t{12} * size.width * size.height * (source.per_sample ? size.spp : 1);
  }
  for (const char* array : kMetaArrays) {
    if (!zip.has(array)) continue;
    const size_t axes = std::string_view(array).ends_with("_mat") ? 2 : 1;
    SPOOL_ASSIGN(plan.meta["camera"][array], small_array(zip, array, axes, options.frame));
  }
  plan.meta["exposure"] = exposure;
  for (const char* layer : {"position", "motion", "normal"})
    plan.meta["channels"][layer] = {{"space", "world"}};
  plan.width = static_cast<uint32_t>(size.width);
  plan.height = static_cast<uint32_t>(size.height);
  plan.spp = static_cast<uint32_t>(size.spp);
  plan.sample_order = format::SampleOrder::kExchangeable;
  plan.record.format = "noisebase";
  if (options.frame) plan.record.options["frame"] = *options.frame;
  plan.record.converted = {"radiance: 8-bit RGBE to f32"};
  SPOOL_ASSIGN(ForeignFile identity, identify(zip.file()));
  plan.record.files.push_back(std::move(identity));
  SPOOL_ASSIGN(ImportReport report, write_dump(out, std::move(plan), options));
  report.notes.push_back(
      "radiance was stored with 8 bits and random rounding: its variance includes that");
  return report;
}

}  // namespace

ImportFormat noisebase_format() {
  using O = NoisebaseImportOptions;
  return import_format<O>(
      "noisebase", "a Zarr v2 zip of one frame, or of a sequence",
      {{"frame", "none|0 .. 2147483647", "which frame of a sequence",
        [](O& options, std::string_view text) -> Result<void> {
          options.frame.reset();
          if (text == "none") return {};
          SPOOL_ASSIGN(const int frame, parse_integer("frame", text, 0, 2147483647));
          options.frame = static_cast<uint64_t>(frame);
          return {};
        },
        [](const O& options) { return options.frame ? std::to_string(*options.frame) : "none"; }}},
      import_noisebase);
}

}  // namespace spool::interchange
