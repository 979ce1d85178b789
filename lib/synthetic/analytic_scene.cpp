#include "lib/synthetic/analytic_scene.h"

#include <algorithm>
#include <utility>

#include "lib/core/parallel.h"
#include "lib/core/random.h"

namespace spool {
namespace {

// Rounds towards zero, so that a position below 1 stays below 1 in float.
float film_coordinate(double u) {
  return std::min(static_cast<float>(u), 0x1.fffffep-1f);
}

}  // namespace

SyntheticSample synthetic_sample(const AnalyticScene& scene, std::uint64_t seed, int x, int y,
                                 int s) {
  const std::uint64_t word = mix(seed, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y),
                                 static_cast<std::uint64_t>(s));
  const auto uniform = [&](std::uint64_t dimension) { return unit_double(mix(word, dimension)); };
  const double u = uniform(0), v = uniform(1);
  const double value = scene.value({x + u, y + v, uniform(2), uniform(3)});
  SyntheticSample sample;
  for (std::size_t c = 0; c < 3; ++c)
    sample.radiance[c] = static_cast<float>(scene.tint[c] * value);
  sample.film = {film_coordinate(u), film_coordinate(v)};
  return sample;
}

ExactImage exact_image(const AnalyticScene& scene) {
  ExactImage exact{make_rgb(scene.width, scene.height), make_rgb(scene.width, scene.height)};
  parallel_rows(0, scene.height, [&](int y) {
    for (int x = 0; x < scene.width; ++x) {
      const Moments moments = scene.moments(x, y);
      for (std::size_t c = 0; c < 3; ++c) {
        exact.mean[c](x, y) = scene.tint[c] * moments.first;
        // Rounding may leave a tiny negative number where the samples do not vary.
        exact.sample_variance[c](x, y) =
            scene.tint[c] * scene.tint[c] * std::max(moments.variance(), 0.0);
      }
    }
  });
  return exact;
}

RecordedSamples make_recording(const AnalyticScene& scene, int spp, std::uint64_t seed,
                               const SanitiseRules& rules) {
  SPOOL_CHECK_GT(spp, 0);
  const std::size_t plane = static_cast<std::size_t>(scene.width) * scene.height * spp;
  std::vector<float> radiance(3 * plane);
  std::vector<FilmPosition> film(plane);
  parallel_rows(0, scene.height, [&](int y) {
    for (int x = 0; x < scene.width; ++x) {
      for (int s = 0; s < spp; ++s) {
        const SyntheticSample sample = synthetic_sample(scene, seed, x, y, s);
        const std::size_t i = (static_cast<std::size_t>(y) * scene.width + x) * spp + s;
        for (std::size_t c = 0; c < 3; ++c)
          radiance[c * plane + i] = sample.radiance[c];
        film[i] = sample.film;
      }
    }
  });
  auto recording = RecordedSamples::from_memory(scene.name, scene.width, scene.height, spp,
                                                std::move(radiance), rules);
  // Only rules that refuse what the caller's own scene makes can fail here.
  if (!recording) fmt::print(stderr, "{}\n", recording.error().message);
  SPOOL_CHECK(recording.has_value());
  recording->set_sample_film(std::move(film));
  recording->set_exchangeable(true);
  recording->set_reference({exact_image(scene).mean, std::nullopt});
  return std::move(*recording);
}

}  // namespace spool
