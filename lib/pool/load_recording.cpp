#include "lib/pool/load_recording.h"

#include <cstdint>
#include <optional>
#include <utility>

#include "formats/bounded_json.h"
#include "formats/layer_components.h"
#include "formats/spool_reader.h"
#include "lib/pool/holding.h"
#include "lib/pool/reference_check.h"

namespace spool {
namespace {

using format::SpoolReader;

// What a recording is deleted by knows its file, for still_intact().
struct WatchedDelete {
  std::shared_ptr<const SpoolReader> file;
  void operator()(const RecordedSamples* samples) const { delete samples; }
};

// Film positions with a value per sample, where they are there.
std::optional<format::LayerInfo> sample_film(const SpoolReader& reader) {
  const auto layer = reader.find_layer("film");
  return layer && layer->scope == format::Scope::kSample ? layer : std::nullopt;
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

Result<void> check_film(const SpoolReader& reader, const BlockView& block) {
  const float* x = block.block.values;
  const float* y = x + block.channel();
  for (std::size_t i = 0; i < block.channel(); ++i) {
    const FilmPosition film{x[i], y[i]};
    if (!is_in_pixel(film)) {
      return outside_pixel(reader, film, block.first + i % static_cast<std::size_t>(block.samples));
    }
  }
  return {};
}

Result<void> load_sample_film(const std::shared_ptr<const SpoolReader>& reader,
                              const format::LayerInfo& layer, const Holding& holding,
                              RecordedSamples& samples) {
  LayerBlocks film = held_layer(reader, layer, holding);
  SPOOL_TRY(film.read_all({.keep = holding.keep()},
                          [&](const BlockView& block) { return check_film(*reader, block); }));
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

Result<void> load_film(const std::shared_ptr<const SpoolReader>& reader, SampleFilm wanted,
                       const Holding& holding, RecordedSamples& samples) {
  const auto layer = reader->find_layer("film");
  if (!layer) return {};
  if (!has_components(*layer, "XY") || layer->scope == format::Scope::kPixel ||
      layer->type == format::DataType::kUint32) {
    return fail(
        ErrorCode::kData,
        "{}: layer film is not X, Y of each sample or pass: record it as formats/spool.md 10 "
        "says",
        reader->path().string());
  }
  if (layer->scope == format::Scope::kPass) return load_pass_film(*reader, samples);
  return wanted == SampleFilm::kLoad ? load_sample_film(reader, *layer, holding, samples)
                                     : Result<void>();
}

Result<RgbImage> pixel_image(const SpoolReader& reader, const format::LayerInfo& layer) {
  if (!has_components(layer, "RGB") || layer.scope != format::Scope::kPixel ||
      layer.type == format::DataType::kUint32) {
    return fail(ErrorCode::kData,
                "{}: layer {} is not R, G, B of each pixel: record it as in formats/spool.md, "
                "section 10",
                reader.path().string(), layer.name);
  }
  const int width = static_cast<int>(reader.header().width);
  const int height = static_cast<int>(reader.header().height);
  SPOOL_ASSIGN(const std::vector<float> values, reader.read_pixel_layer(layer.name));
  RgbImage image = make_rgb(width, height);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t p = 0; p < image[c].size(); ++p)
      image[c][p] = values[c * image[c].size() + p];
  }
  return image;
}

Result<void> load_reference(const SpoolReader& reader, RecordedSamples& samples) {
  const auto mean = reader.find_layer("reference");
  if (!mean) return {};
  Reference reference;
  SPOOL_ASSIGN(reference.mean, pixel_image(reader, *mean));
  if (const auto variance = reader.find_layer("reference_variance")) {
    SPOOL_ASSIGN(reference.variance_of_mean, pixel_image(reader, *variance));
  }
  SPOOL_TRY(check_reference(reference, reader.path().string()));
  samples.set_reference(std::move(reference));
  return {};
}

// Layers of known names with a value per sample; read later, if at all.
void offer_features(const std::shared_ptr<const SpoolReader>& reader, RecordedSamples& samples) {
  std::vector<FeatureLayer> features;
  for (const auto& [name, components] :
       {std::pair{"albedo", "RGB"}, {"normal", "XYZ"}, {"depth", "Z"}}) {
    const auto layer = reader->find_layer(name);
    if (layer && layer->scope == format::Scope::kSample && has_components(*layer, components))
      features.push_back({name, components});
  }
  samples.set_features(
      std::move(features), [reader](const FeatureLayer& layer, const Rectangle& pixels, int count) {
        const format::PixelRect rect{
            static_cast<std::uint32_t>(pixels.x0), static_cast<std::uint32_t>(pixels.y0),
            static_cast<std::uint32_t>(pixels.x1), static_cast<std::uint32_t>(pixels.y1)};
        return reader->read_region(layer.name, rect, 0, static_cast<std::uint32_t>(count));
      });
}

// The last `cost_per_sample` holds, as the format requires; one that is no positive number is none.
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
                                                              SampleFilm film, FirstPass* pass) {
  SPOOL_ASSIGN(SpoolReader opened, SpoolReader::open(path));
  const auto reader = std::make_shared<const SpoolReader>(std::move(opened));
  const format::LayerInfo radiance = *reader->find_layer("radiance");
  std::vector<format::LayerInfo> layers{radiance};
  if (const auto positions = sample_film(*reader); positions && film == SampleFilm::kLoad) {
    layers.push_back(*positions);
  }
  SPOOL_ASSIGN(const Holding holding, choose_holding(*reader, layers, work));
  SPOOL_ASSIGN(RecordedSamples samples,
               RecordedSamples::create(path.string(), held_layer(reader, radiance, holding),
                                       holding.keep(), rules, pass));
  samples.set_exchangeable(reader->header().sample_order == format::SampleOrder::kExchangeable);
  SPOOL_TRY(load_film(reader, film, holding, samples));
  SPOOL_TRY(load_reference(*reader, samples));
  load_cost(*reader, samples);
  offer_features(reader, samples);
  SPOOL_TRY(reader->intact());
  return std::shared_ptr<const RecordedSamples>(new RecordedSamples(std::move(samples)),
                                                WatchedDelete{reader});
}

Result<void> still_intact(const std::shared_ptr<const RecordedSamples>& recording) {
  if (!recording) return {};  // it was refused: its cells say why
  const auto* watched = std::get_deleter<WatchedDelete>(recording);
  SPOOL_TRY(recording->failure());
  return watched != nullptr ? watched->file->intact() : Result<void>();
}

}  // namespace spool
