#include "lib/pool/load_recording.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>

#include "formats/bounded_json.h"
#include "formats/half_float.h"
#include "formats/spool_reader.h"
#include "lib/core/available_memory.h"
#include "lib/core/parallel.h"

namespace spool {
namespace {

using format::DataType;
using format::SpoolReader;

static_assert(std::endian::native == std::endian::little,
              "samples are used as they lie in the file");

// What the block pointers of a recording point into.
struct FileStorage {
  explicit FileStorage(SpoolReader opened) : reader(std::move(opened)) {}
  SpoolReader reader;
  std::vector<std::vector<float>> decoded;  // [tile][block], empty where the file is mapped
};

// What a recording is deleted by knows its file, for still_intact().
struct WatchedDelete {
  std::shared_ptr<const FileStorage> storage;
  void operator()(const RecordedSamples* samples) const { delete samples; }
};

std::vector<float> as_floats(const std::vector<std::byte>& bytes, DataType type) {
  if (type == DataType::kFloat32) {
    std::vector<float> values(bytes.size() / sizeof(float));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(float));
    return values;
  }
  std::vector<float> values(bytes.size() / sizeof(std::uint16_t));
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::uint16_t half = 0;
    std::memcpy(&half, bytes.data() + i * sizeof(half), sizeof(half));
    values[i] = format::half_to_float(half);
  }
  return values;
}

Result<const float*> place_block(FileStorage& storage, std::uint32_t tile, std::uint32_t block) {
  const SpoolReader& reader = storage.reader;
  const DataType type = reader.header().channels[0].type;
  if (!reader.has_block(0, tile, block)) {
    const format::PixelRect rect = reader.tile_rect(tile);
    const std::uint32_t begin = reader.block_begin(block);
    return fail(
        ErrorCode::kDamage,
        "{}: samples {}-{} of tile {} (pixels {},{} to {},{}) were not recorded: record them, "
        "or use a recording that is complete",
        reader.path().string(), begin, begin + reader.block_count(block) - 1, tile, rect.x0,
        rect.y0, rect.x1 - 1, rect.y1 - 1);
  }
  if (type == DataType::kFloat32 && reader.is_raw(0, tile, block)) {
    SPOOL_ASSIGN(const auto bytes, reader.map_block(0, tile, block));
    return reinterpret_cast<const float*>(bytes.data());  // payloads start at a multiple of 64
  }
  SPOOL_ASSIGN(const auto bytes, reader.read_block(0, tile, block));
  std::vector<float>& values =
      storage.decoded[static_cast<std::size_t>(tile) * reader.blocks() + block];
  values = as_floats(bytes, type);
  return values.data();
}

Result<std::vector<const float*>> place_blocks(FileStorage& storage) {
  const std::size_t blocks = storage.reader.blocks();
  const std::size_t count = blocks * storage.reader.tiles();
  storage.decoded.resize(count);
  std::vector<Result<const float*>> placed(count, nullptr);
  parallel_for(count, [&](std::size_t i) {
    placed[i] = place_block(storage, static_cast<std::uint32_t>(i / blocks),
                            static_cast<std::uint32_t>(i % blocks));
  });
  std::vector<const float*> pointers;
  for (Result<const float*>& block : placed) {
    SPOOL_ASSIGN(const float* pointer, std::move(block));
    pointers.push_back(pointer);
  }
  return pointers;
}

// What loading keeps in memory: blocks that cannot be used where they lie, film positions and the
// reference.
std::uint64_t bytes_to_load(const SpoolReader& reader, SampleFilm wanted) {
  const format::DumpHeader& header = reader.header();
  const std::uint64_t pixels = std::uint64_t{header.width} * header.height;
  std::uint64_t bytes = 0;
  for (const char* layer : {"reference", "reference_variance"}) {
    if (reader.find_layer(layer)) bytes += pixels * 3 * sizeof(double);
  }
  const bool is_float = header.channels[0].type == DataType::kFloat32;
  for (std::uint32_t tile = 0; tile < reader.tiles(); ++tile) {
    const format::PixelRect rect = reader.tile_rect(tile);
    const std::uint64_t area = std::uint64_t{rect.x1 - rect.x0} * (rect.y1 - rect.y0);
    for (std::uint32_t block = 0; block < reader.blocks(); ++block) {
      if (is_float && reader.has_block(0, tile, block) && reader.is_raw(0, tile, block)) continue;
      bytes += area * reader.block_count(block) * 3 * sizeof(float);
    }
  }
  const auto film = reader.find_layer("film");
  if (wanted == SampleFilm::kLoad && film && film->scope == format::Scope::kSample) {
    bytes += pixels * header.spp * sizeof(FilmPosition);
  }
  return bytes;
}

Result<void> check_memory(const SpoolReader& reader, const WorkingMemory& work, SampleFilm film) {
  const double pixels = static_cast<double>(reader.header().width) * reader.header().height;
  const double needed =
      static_cast<double>(bytes_to_load(reader, film)) + work.fixed + work.per_pixel * pixels;
  const std::optional<std::uint64_t> available = available_memory(reader.file_bytes());
  if (!available || needed <= static_cast<double>(*available)) return {};
  return fail(ErrorCode::kData,
              "{}: needs about {:.3g} GB of memory, {:.3g} GB are free: record it as f32 without "
              "--compress, which stays in the file, or crop it, or raise the limit, or use a "
              "larger machine",
              reader.path().string(), needed / 1e9, static_cast<double>(*available) / 1e9);
}

// Written so that NaN fails.
bool is_in_pixel(const FilmPosition& film) {
  return film.x >= 0.0f && film.x < 1.0f && film.y >= 0.0f && film.y < 1.0f;
}

tl::unexpected<Error> outside_pixel(const SpoolReader& reader, const FilmPosition& film,
                                    std::size_t sample) {
  return fail(ErrorCode::kData,
              "{}: film position {},{} of sample {} is outside [0, 1): record it again",
              reader.path().string(), film.x, film.y, sample);
}

// Tile by tile, so that the values are in memory once.
Result<void> load_sample_film(const SpoolReader& reader, RecordedSamples& samples) {
  const auto width = static_cast<std::size_t>(samples.width());
  const auto spp = static_cast<std::size_t>(samples.spp());
  std::vector<FilmPosition> film(width * static_cast<std::size_t>(samples.height()) * spp);
  for (std::uint32_t tile = 0; tile < reader.tiles(); ++tile) {
    const format::PixelRect rect = reader.tile_rect(tile);
    SPOOL_ASSIGN(const std::vector<float> values,
                 reader.read_region("film", rect, 0, reader.header().spp));
    const std::size_t plane = values.size() / 2;
    const float* from = values.data();
    for (std::size_t y = rect.y0; y < rect.y1; ++y) {
      FilmPosition* to = &film[(y * width + rect.x0) * spp];
      for (std::size_t i = 0; i < rect.width() * spp; ++i, ++from, ++to) {
        *to = {*from, from[plane]};
        if (!is_in_pixel(*to)) return outside_pixel(reader, *to, i % spp);
      }
    }
  }
  samples.set_sample_film(std::move(film));
  return {};
}

Result<void> load_pass_film(const SpoolReader& reader, RecordedSamples& samples) {
  SPOOL_ASSIGN(const std::vector<float> values, reader.read_pass_layer("film"));
  std::vector<FilmPosition> film(values.size() / 2);
  for (std::size_t s = 0; s < film.size(); ++s) {
    film[s] = {values[s], values[film.size() + s]};
    if (!is_in_pixel(film[s])) return outside_pixel(reader, film[s], s);
  }
  samples.set_pass_film(std::move(film));
  return {};
}

Result<void> load_film(const SpoolReader& reader, SampleFilm wanted, RecordedSamples& samples) {
  const auto layer = reader.find_layer("film");
  if (!layer) return {};
  if (layer->components != std::vector<std::string>{"X", "Y"} ||
      layer->scope == format::Scope::kPixel) {
    return fail(
        ErrorCode::kData,
        "{}: layer film is not X, Y of each sample or pass: record it as formats/spool.md 10 "
        "says",
        reader.path().string());
  }
  if (layer->scope == format::Scope::kPass) return load_pass_film(reader, samples);
  return wanted == SampleFilm::kLoad ? load_sample_film(reader, samples) : Result<void>();
}

Result<RgbImage> pixel_image(const SpoolReader& reader, const char* layer) {
  const int width = static_cast<int>(reader.header().width);
  const int height = static_cast<int>(reader.header().height);
  SPOOL_ASSIGN(const std::vector<float> values, reader.read_pixel_layer(layer));
  RgbImage image = make_rgb(width, height);
  if (values.size() != 3 * image[0].size()) {
    return fail(ErrorCode::kData,
                "{}: layer {} is not R, G, B: record it as formats/spool.md 10 says",
                reader.path().string(), layer);
  }
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t p = 0; p < image[c].size(); ++p)
      image[c][p] = values[c * image[c].size() + p];
  }
  return image;
}

Result<void> load_reference(const SpoolReader& reader, RecordedSamples& samples) {
  if (!reader.find_layer("reference")) return {};
  Reference reference;
  SPOOL_ASSIGN(reference.mean, pixel_image(reader, "reference"));
  if (reader.find_layer("reference_variance")) {
    SPOOL_ASSIGN(reference.variance_of_mean, pixel_image(reader, "reference_variance"));
  }
  samples.set_reference(std::move(reference));
  return {};
}

// Layers of known names with a value per sample; read later, if at all.
void offer_features(const std::shared_ptr<FileStorage>& storage, RecordedSamples& samples) {
  std::vector<FeatureLayer> features;
  for (const auto& [name, components] :
       {std::pair{"albedo", "RGB"}, {"normal", "XYZ"}, {"depth", "Z"}}) {
    const auto layer = storage->reader.find_layer(name);
    if (!layer || layer->scope != format::Scope::kSample) continue;
    std::string letters;
    for (const std::string& component : layer->components)
      letters += component;
    if (letters == components) features.push_back({name, components});
  }
  samples.set_features(std::move(features), [storage](const FeatureLayer& layer,
                                                      const Rectangle& pixels, int count) {
    const format::PixelRect rect{
        static_cast<std::uint32_t>(pixels.x0), static_cast<std::uint32_t>(pixels.y0),
        static_cast<std::uint32_t>(pixels.x1), static_cast<std::uint32_t>(pixels.y1)};
    return storage->reader.read_region(layer.name, rect, 0, static_cast<std::uint32_t>(count));
  });
}

// The last `cost_per_sample` holds, as the format wants; one that is no positive number is none.
void load_cost(const SpoolReader& reader, RecordedSamples& samples) {
  double seconds = 0.0;
  for (const std::string& text : reader.meta()) {
    const auto meta = format::parse_json(text);
    if (!meta.is_object()) continue;  // the reader has checked it; this is for the type's sake
    const auto cost = meta.find("cost_per_sample");
    if (cost != meta.end()) seconds = cost->is_number() ? cost->get<double>() : 0.0;
  }
  if (seconds > 0.0) samples.set_cost_per_sample(seconds);
}

}  // namespace

Result<std::shared_ptr<const RecordedSamples>> load_recording(const std::filesystem::path& path,
                                                              const SanitiseRules& rules,
                                                              const WorkingMemory& work,
                                                              SampleFilm film) {
  SPOOL_ASSIGN(SpoolReader opened, SpoolReader::open(path));
  auto storage = std::make_shared<FileStorage>(std::move(opened));
  const SpoolReader& reader = storage->reader;
  const format::DumpHeader& header = reader.header();
  RadianceLayout layout;
  layout.width = static_cast<int>(header.width);
  layout.height = static_cast<int>(header.height);
  layout.spp = static_cast<int>(header.spp);
  layout.tile_size = static_cast<int>(header.tile_size);
  layout.block_spp = static_cast<int>(header.block_spp);
  SPOOL_TRY(check_memory(reader, work, film));
  SPOOL_ASSIGN(layout.blocks, place_blocks(*storage));
  SPOOL_ASSIGN(RecordedSamples samples,
               RecordedSamples::create(path.string(), std::move(layout), storage, rules));
  samples.set_exchangeable(header.sample_order == format::SampleOrder::kExchangeable);
  SPOOL_TRY(load_film(reader, film, samples));
  SPOOL_TRY(load_reference(reader, samples));
  load_cost(reader, samples);
  offer_features(storage, samples);
  SPOOL_TRY(reader.intact());
  return std::shared_ptr<const RecordedSamples>(new RecordedSamples(std::move(samples)),
                                                WatchedDelete{storage});
}

Result<void> still_intact(const std::shared_ptr<const RecordedSamples>& recording) {
  const auto* watched = std::get_deleter<WatchedDelete>(recording);
  return watched != nullptr ? watched->storage->reader.intact() : Result<void>();
}

}  // namespace spool
