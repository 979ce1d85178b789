#include "lib/synthetic/write_synthetic.h"

#include <algorithm>
#include <span>
#include <vector>

#include <nlohmann/json.hpp>

#include "lib/core/parallel.h"

namespace spool {
namespace {

using format::Scope;
using format::Semantic;

enum Group : std::uint16_t { kRadiance = 0, kFilm = 1, kReference = 2 };

format::DumpHeader header_of(const AnalyticScene& scene, int spp,
                             const WriteSyntheticOptions& options) {
  format::DumpHeader header;
  header.width = static_cast<std::uint32_t>(scene.width);
  header.height = static_cast<std::uint32_t>(scene.height);
  header.spp = static_cast<std::uint32_t>(spp);
  header.tile_size = static_cast<std::uint32_t>(options.tile_size);
  header.block_spp = static_cast<std::uint32_t>(options.block_spp);
  header.sample_order = format::SampleOrder::kExchangeable;
  header.channels = format::radiance_channels();
  const auto add = [&](const char* name, Group group, Semantic semantic, Scope scope) {
    header.channels.push_back(
        {name, group, format::DataType::kFloat32, static_cast<std::uint16_t>(semantic), scope});
  };
  add("film.X", kFilm, Semantic::kSampleCoordinate, Scope::kSample);
  add("film.Y", kFilm, Semantic::kSampleCoordinate, Scope::kSample);
  for (const char* name : {"reference.R", "reference.G", "reference.B"})
    add(name, kReference, Semantic::kLight, Scope::kPixel);
  for (const char* name : {"reference_variance.R", "reference_variance.G", "reference_variance.B",
                           "sample_variance.R", "sample_variance.G", "sample_variance.B"})
    add(name, kReference, Semantic::kLightVariance, Scope::kPixel);
  return header;
}

Result<void> write_floats(format::SpoolWriter& writer, Group group, int tile, int begin, int count,
                          const std::vector<float>& values) {
  return writer.write_block(group, static_cast<std::uint32_t>(tile),
                            static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(count),
                            std::as_bytes(std::span(values)));
}

Result<void> write_samples(format::SpoolWriter& writer, const AnalyticScene& scene,
                           std::uint64_t seed, int tile, const Rectangle& rect, int begin,
                           int count) {
  const std::size_t plane = static_cast<std::size_t>(rect.area()) * count;
  std::vector<float> radiance(3 * plane), film(2 * plane);
  parallel_rows(rect.y0, rect.y1, [&](int y) {
    for (int x = rect.x0; x < rect.x1; ++x) {
      for (int s = 0; s < count; ++s) {
        const SyntheticSample sample = synthetic_sample(scene, seed, x, y, begin + s);
        const std::size_t i =
            (static_cast<std::size_t>(y - rect.y0) * rect.width() + (x - rect.x0)) * count + s;
        for (std::size_t c = 0; c < 3; ++c)
          radiance[c * plane + i] = sample.radiance[c];
        film[i] = sample.film.x;
        film[plane + i] = sample.film.y;
      }
    }
  });
  SPOOL_TRY(write_floats(writer, kRadiance, tile, begin, count, radiance));
  return write_floats(writer, kFilm, tile, begin, count, film);
}

Result<void> write_reference(format::SpoolWriter& writer, const AnalyticScene& scene, int tile,
                             const Rectangle& rect) {
  const auto plane = static_cast<std::size_t>(rect.area());
  std::vector<float> values(9 * plane, 0.0f);  // the variance of an exact reference is 0
  parallel_rows(rect.y0, rect.y1, [&](int y) {
    for (int x = rect.x0; x < rect.x1; ++x) {
      const Moments moments = scene.moments(x, y);
      const std::size_t i = static_cast<std::size_t>(y - rect.y0) * rect.width() + (x - rect.x0);
      for (std::size_t c = 0; c < 3; ++c) {
        const double tint = scene.tint[c];
        values[c * plane + i] = static_cast<float>(tint * moments.first);
        // Rounding may leave a tiny negative number where the samples do not vary.
        values[(6 + c) * plane + i] =
            static_cast<float>(tint * tint * std::max(moments.variance(), 0.0));
      }
    }
  });
  return write_floats(writer, kReference, tile, 0, 1, values);
}

}  // namespace

Result<void> write_synthetic(std::string_view name, int width, int height, int spp,
                             std::uint64_t seed, const std::filesystem::path& path,
                             const WriteSyntheticOptions& options) {
  SPOOL_ASSIGN(const AnalyticScene scene, synthetic_scene(name, width, height, options.scene));
  if (spp < 1) return fail(ErrorCode::kUsage, "{} samples per pixel: give at least 1", spp);
  SPOOL_ASSIGN(format::SpoolWriter writer,
               format::SpoolWriter::create(path, header_of(scene, spp, options), options.writer));
  nlohmann::json meta = {{"renderer", "synthetic"}, {"scene", scene.name}, {"seed", seed}};
  for (const auto& [option, value] : option_values(synthetic_option_table(), options.scene))
    meta["options"][option] = value;
  SPOOL_TRY(writer.write_meta(meta.dump()));

  const int size = options.tile_size;
  const int tiles_x = (width + size - 1) / size, tiles_y = (height + size - 1) / size;
  for (int tile = 0; tile < tiles_x * tiles_y; ++tile) {
    const int x = tile % tiles_x * size, y = tile / tiles_x * size;
    const Rectangle rect = intersect({x, y, x + size, y + size}, {0, 0, width, height});
    for (int begin = 0; begin < spp; begin += options.block_spp) {
      const int count = std::min(options.block_spp, spp - begin);
      SPOOL_TRY(write_samples(writer, scene, seed, tile, rect, begin, count));
    }
    SPOOL_TRY(write_reference(writer, scene, tile, rect));
    if (options.progress) options.progress((tile + 1.0) / (tiles_x * tiles_y));
  }
  return writer.finish();
}

}  // namespace spool
