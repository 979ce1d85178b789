#include "tools/python/source.h"

#include <sys/stat.h>

#include <algorithm>

namespace spool::python {
namespace {

constexpr std::size_t kKept = 2;  // with film positions and without

LayerGrid whole(const SampleArray& array) {
  const int height = static_cast<int>(array.shape(1)), width = static_cast<int>(array.shape(2));
  const int spp = static_cast<int>(array.shape(3));
  return {width, height, spp, std::max(width, height), spp};
}

// The first samples of a rectangle of pixels, [c][y][x][s].
std::vector<float> region_of(const SampleArray& array, const Rectangle& pixels, int samples) {
  const std::size_t height = array.shape(1), width = array.shape(2), spp = array.shape(3);
  std::vector<float> values;
  values.reserve(array.shape(0) * static_cast<std::size_t>(pixels.area()) *
                 static_cast<std::size_t>(samples));
  for (std::size_t c = 0; c < array.shape(0); ++c) {
    for (int y = pixels.y0; y < pixels.y1; ++y) {
      for (int x = pixels.x0; x < pixels.x1; ++x) {
        const float* first = array.data() + ((c * height + static_cast<std::size_t>(y)) * width +
                                             static_cast<std::size_t>(x)) *
                                                spp;
        values.insert(values.end(), first, first + samples);
      }
    }
  }
  return values;
}

// Written so that NaN fails.
Result<std::vector<FilmPosition>> film_of(const SampleArray& array, const std::string& name) {
  const std::size_t count = array.size() / 2;
  std::vector<FilmPosition> film(count);
  for (std::size_t i = 0; i < count; ++i) {
    film[i] = {array.data()[i], array.data()[count + i]};
    const bool inside =
        film[i].x >= 0.0f && film[i].x < 1.0f && film[i].y >= 0.0f && film[i].y < 1.0f;
    if (inside) continue;
    return fail(ErrorCode::kData, "{}: film position {},{} is outside [0, 1): record it again",
                name, film[i].x, film[i].y);
  }
  return film;
}

Result<std::shared_ptr<const RecordedSamples>> recording_of(const SampleArrays& arrays,
                                                            const std::string& name,
                                                            const SanitiseRules& rules,
                                                            SampleFilm film) {
  RadianceLayout layout{whole(arrays.radiance), {arrays.radiance.data()}};
  SPOOL_ASSIGN(
      RecordedSamples samples,
      RecordedSamples::create(name, std::move(layout),
                              std::make_shared<const SampleArray>(arrays.radiance), rules));
  samples.set_exchangeable(arrays.exchangeable);
  if (arrays.film && film == SampleFilm::kLoad) {
    SPOOL_ASSIGN(const std::vector<FilmPosition> positions, film_of(*arrays.film, name));
    samples.set_sample_film(positions);
  }
  if (arrays.reference) samples.set_reference(*arrays.reference);
  std::vector<FeatureLayer> layers;
  layers.reserve(arrays.features.size());
  for (const auto& [layer, values] : arrays.features)
    layers.push_back(layer);
  samples.set_features(
      std::move(layers),
      [features = arrays.features](const FeatureLayer& layer, const Rectangle& pixels,
                                   int count) -> Result<std::vector<float>> {
        for (const auto& [known, values] : features) {
          if (known.name == layer.name) return region_of(values, pixels, count);
        }
        return fail(ErrorCode::kUsage, "no layer {}", layer.name);
      });
  return std::make_shared<const RecordedSamples>(std::move(samples));
}

}  // namespace

Result<void> Source::is_that_file() const {
  struct stat found{};
  if (::stat(name_.c_str(), &found) == 0 && FileId{found.st_dev, found.st_ino} == opened_)
    return {};
  return fail(ErrorCode::kUsage, "{}: is not the file that was opened: open it again", name());
}

Result<std::shared_ptr<const RecordedSamples>> Source::load(const SanitiseRules& rules,
                                                            const WorkingMemory& work,
                                                            SampleFilm film) {
  const std::lock_guard lock(mutex_);
  const OptionValues wanted = option_values(sanitise_option_table(), rules);
  for (const Loaded& loaded : kept_) {
    if (loaded.rules != wanted || loaded.film != film) continue;
    SPOOL_TRY(still_intact(loaded.samples));
    return loaded.samples;
  }
  if (kept_.size() == kKept) kept_.erase(kept_.begin());
  SPOOL_ASSIGN(auto samples, arrays_ ? recording_of(*arrays_, name(), rules, film)
                                     : load_recording(name_, rules, work, film));
  if (!arrays_) SPOOL_TRY(is_that_file());
  kept_.push_back({wanted, film, samples});
  return samples;
}

}  // namespace spool::python
