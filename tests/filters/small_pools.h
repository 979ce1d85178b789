// Small pools in memory for the tests of filters.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/core/random.h"
#include "lib/pool/sample_pool.h"
#include "lib/statistics/joined_halves.h"
#include "lib/statistics/selection.h"
#include "tests/support/made_features.h"

namespace spool::testing {

// radiance(x, y, s) -> Rgb
using RadianceFunction = std::function<Rgb(int, int, int)>;
// feature(layer, component, x, y, s)
using FeatureFunction = std::function<double(std::string_view, std::size_t, int, int, int)>;

// The same for every pixel, as passes of a recorder have them.
inline std::vector<FilmPosition> random_film(int spp) {
  std::vector<FilmPosition> film;
  for (int s = 0; s < spp; ++s) {
    film.push_back(
        {static_cast<float>(unit_double(mix(1, s))), static_cast<float>(unit_double(mix(2, s)))});
  }
  return film;
}

inline SamplePool make_pool(int width, int height, int spp, const RadianceFunction& radiance,
                            const PoolOptions& options = {},
                            std::vector<FilmPosition> pass_film = {},
                            const FeatureFunction& feature = {}) {
  std::vector<float> values(static_cast<std::size_t>(3) * width * height * spp);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int s = 0; s < spp; ++s) {
        const Rgb value = radiance(x, y, s);
        for (std::size_t c = 0; c < 3; ++c) {
          values[((c * height + y) * width + x) * spp + s] = value[c];
        }
      }
    }
  }
  auto recording = RecordedSamples::from_memory("memory", width, height, spp, std::move(values));
  SPOOL_CHECK(recording.has_value());
  if (feature) {
    test::add_features(*recording, feature);
  } else {
    test::add_features(*recording);
  }
  if (!pass_film.empty()) recording->set_pass_film(std::move(pass_film));
  auto pool =
      SamplePool::create(std::make_shared<const RecordedSamples>(std::move(*recording)), options);
  SPOOL_CHECK(pool.has_value());
  return std::move(*pool);
}

inline Selection select_uniform(const SamplePool& pool, int spp) {
  return {prefix_statistics(pool, CountImage(pool.width(), pool.height(), spp)), {}};
}

// n(x, y) = count(x, y), clipped to what the pool holds.
inline Selection select_counts(const SamplePool& pool, const std::function<int(int, int)>& count) {
  CountImage counts(pool.width(), pool.height());
  for (int y = 0; y < pool.height(); ++y) {
    for (int x = 0; x < pool.width(); ++x)
      counts(x, y) = std::min(count(x, y), pool.capacity(x, y));
  }
  return {prefix_statistics(pool, counts), {}};
}

// 1 to 4 samples of the even half of a piece and 1 to 3 of the odd one.
inline Selection joined_halves(const SamplePool& pool) {
  std::vector<Selection> halves;
  for (int h = 0; h < 2; ++h)
    halves.push_back(select_counts(pool.half(h), [&](int x, int y) {
      return 1 + (h == 0 ? x + 2 * y : 3 * x + y) % (4 - h);
    }));
  return join_halves(pool, std::move(halves));
}

// A noisy picture with a gradient, an edge and a disc; `key` chooses the noise.
inline RadianceFunction noisy_picture(int width, int height, std::uint64_t key) {
  return [=](int x, int y, int s) -> Rgb {
    const double u = unit_double(mix(key, x, y, s, 1)), v = unit_double(mix(key, x, y, s, 2));
    const double noise = std::sqrt(-2.0 * std::log(1.0 - u)) * std::cos(6.283185307179586 * v);
    double value = 0.3 + 0.4 * x / width;
    if (2 * x + y > width + height / 2) value += 0.5;
    const double dx = x - 0.3 * width, dy = y - 0.7 * height;
    if (dx * dx + dy * dy < 0.03 * width * height) value = 1.2;
    value += 0.1 * noise;
    return {static_cast<float>(value), static_cast<float>(0.8 * value + 0.02),
            static_cast<float>(0.5 * value + 0.05 * v)};
  };
}

}  // namespace spool::testing
