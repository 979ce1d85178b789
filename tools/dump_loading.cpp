#include "tools/dump_loading.h"

#include <cstring>
#include <vector>

#include "lib/core/parallel.h"

namespace spool::tools {
namespace {

using format::SpoolReader;

// What block pointers of a recording point into: the mapped file, and blocks that had to be
// decoded.
struct Storage {
  explicit Storage(SpoolReader opened) : reader(std::move(opened)) {}

  SpoolReader reader;
  std::vector<std::vector<float>> decoded;
};

// Radiance is channels 0, 1, 2 of group 0 [spool.md 5], so a block's first three channels are it.
Result<const float*> block_values(Storage& storage, std::uint32_t tile, std::uint32_t block,
                                  std::vector<float>& decoded) {
  const SpoolReader& reader = storage.reader;
  if (!reader.has_block(0, tile, block)) {
    return fail(ErrorCode::kDamage,
                "{}: tile {} has no samples {} .. {}: record it again or use fewer samples",
                reader.path().string(), tile, reader.block_begin(block),
                reader.block_begin(block) + reader.block_count(block) - 1);
  }
  const bool is_float = reader.header().channels.front().type == format::DataType::kFloat32;
  if (is_float && reader.is_raw(0, tile, block)) {
    SPOOL_ASSIGN(const std::span<const std::byte> bytes, reader.map_block(0, tile, block));
    return reinterpret_cast<const float*>(bytes.data());  // payloads start at multiples of 64
  }
  SPOOL_ASSIGN(decoded, reader.read_region("radiance", reader.tile_rect(tile),
                                           reader.block_begin(block), reader.block_count(block)));
  return decoded.data();
}

RgbImage planes(const std::vector<float>& values, int width, int height) {
  RgbImage image = make_rgb(width, height);
  const std::size_t pixels = image[0].size();
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < pixels; ++i) {
      image[c][i] = static_cast<double>(values[c * pixels + i]);
    }
  }
  return image;
}

bool has_rgb(const SpoolReader& reader, std::string_view layer) {
  const auto found = reader.find_layer(layer);
  return found && found->scope == format::Scope::kPixel && found->channel_count == 3;
}

Result<void> load_reference(const SpoolReader& reader, RecordedSamples& recording) {
  if (!has_rgb(reader, "reference")) return {};
  const int width = recording.width();
  const int height = recording.height();
  Reference reference;
  SPOOL_ASSIGN(const std::vector<float> mean, reader.read_pixel_layer("reference"));
  reference.mean = planes(mean, width, height);
  if (has_rgb(reader, "reference_variance")) {
    SPOOL_ASSIGN(const std::vector<float> variance, reader.read_pixel_layer("reference_variance"));
    reference.variance_of_mean = planes(variance, width, height);
  }
  recording.set_reference(std::move(reference));
  return {};
}

Result<void> load_film(const SpoolReader& reader, RecordedSamples& recording) {
  const auto film = reader.find_layer("film");
  if (!film || film->channel_count != 2 || film->type == format::DataType::kUint32) return {};
  const auto spp = static_cast<std::size_t>(recording.spp());
  const auto pixels =
      static_cast<std::size_t>(recording.width()) * static_cast<std::size_t>(recording.height());
  if (film->scope == format::Scope::kPass) {
    SPOOL_ASSIGN(const std::vector<float> values, reader.read_pass_layer("film"));
    std::vector<FilmPosition> positions(spp);
    for (std::size_t s = 0; s < spp; ++s)
      positions[s] = {values[s], values[spp + s]};
    recording.set_pass_film(std::move(positions));
  } else if (film->scope == format::Scope::kSample) {
    const format::PixelRect all{0, 0, reader.header().width, reader.header().height};
    SPOOL_ASSIGN(const std::vector<float> values,
                 reader.read_region("film", all, 0, reader.header().spp));
    std::vector<FilmPosition> positions(pixels * spp);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      positions[i] = {values[i], values[pixels * spp + i]};
    }
    recording.set_sample_film(std::move(positions));
  }
  return {};
}

}  // namespace

nlohmann::ordered_json merged_meta(const SpoolReader& reader) {
  nlohmann::ordered_json merged = nlohmann::ordered_json::object();
  for (const std::string& text : reader.meta()) {
    const auto part = nlohmann::ordered_json::parse(text, nullptr, false);
    if (!part.is_object()) continue;  // the reader has checked it; this is for the type's sake
    for (const auto& [key, value] : part.items())
      merged[key] = value;
  }
  return merged;
}

std::optional<double> cost_per_sample(const nlohmann::ordered_json& meta) {
  const auto found = meta.find("cost_per_sample");
  if (found == meta.end() || !found->is_number()) return std::nullopt;
  const double seconds = found->get<double>();
  return seconds > 0.0 ? std::optional(seconds) : std::nullopt;
}

Result<std::shared_ptr<const RecordedSamples>> load_recording(const std::filesystem::path& path,
                                                              const SanitiseRules& rules) {
  SPOOL_ASSIGN(SpoolReader opened, SpoolReader::open(path));
  const auto storage = std::make_shared<Storage>(std::move(opened));
  const SpoolReader& reader = storage->reader;
  const format::DumpHeader& header = reader.header();
  const std::size_t tiles = reader.tiles();
  const std::size_t blocks = reader.blocks();
  RadianceLayout layout{.width = static_cast<int>(header.width),
                        .height = static_cast<int>(header.height),
                        .spp = static_cast<int>(header.spp),
                        .tile_size = static_cast<int>(header.tile_size),
                        .block_spp = static_cast<int>(header.block_spp),
                        .blocks = std::vector<const float*>(tiles * blocks)};
  storage->decoded.resize(tiles * blocks);
  std::vector<Result<void>> loaded(tiles);
  parallel_for(tiles, [&](std::size_t tile) {
    for (std::size_t block = 0; block < blocks && loaded[tile]; ++block) {
      const std::size_t i = tile * blocks + block;
      const auto values = block_values(*storage, static_cast<std::uint32_t>(tile),
                                       static_cast<std::uint32_t>(block), storage->decoded[i]);
      if (values) {
        layout.blocks[i] = *values;
      } else {
        loaded[tile] = tl::unexpected<Error>(values.error());
      }
    }
  });
  for (const Result<void>& result : loaded)
    SPOOL_TRY(result);
  SPOOL_ASSIGN(RecordedSamples recording,
               RecordedSamples::create(path.string(), std::move(layout), storage, rules));
  recording.set_exchangeable(header.sample_order == format::SampleOrder::kExchangeable);
  if (const auto seconds = cost_per_sample(merged_meta(reader))) {
    recording.set_cost_per_sample(*seconds);
  }
  SPOOL_TRY(load_reference(reader, recording));
  SPOOL_TRY(load_film(reader, recording));
  return std::make_shared<const RecordedSamples>(std::move(recording));
}

}  // namespace spool::tools
