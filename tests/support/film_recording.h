// A recording in memory with a film position of every sample.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "lib/core/random.h"
#include "lib/pool/recorded_samples.h"
#include "tests/support/made_features.h"

namespace spool::test {

// radiance(x, y, s, film) -> Rgb.
template <class Radiance>
std::shared_ptr<const RecordedSamples> film_recording(int width, int height, int spp,
                                                      Radiance&& radiance) {
  const std::size_t plane = static_cast<std::size_t>(width) * height * spp;
  std::vector<float> values(3 * plane);
  std::vector<FilmPosition> positions;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int s = 0; s < spp; ++s) {
        const std::size_t i = positions.size();
        positions.push_back({static_cast<float>(unit_double(mix(71, i))),
                             static_cast<float>(unit_double(mix(72, i)))});
        const Rgb value = radiance(x, y, s, positions.back());
        for (std::size_t c = 0; c < 3; ++c)
          values[c * plane + i] = value[c];
      }
    }
  }
  auto recording = RecordedSamples::from_memory("film", width, height, spp, std::move(values));
  SPOOL_CHECK(recording.has_value());
  recording->set_sample_film(positions);
  add_features(*recording);
  return std::make_shared<const RecordedSamples>(std::move(*recording));
}

}  // namespace spool::test
