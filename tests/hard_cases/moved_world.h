// A small world of samples that can be mirrored, turned, scaled and shifted before it is recorded.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/statistics/selection.h"
#include "tests/support/memory_pool.h"
#include "tests/support/random_images.h"

namespace spool::test {

// What is recorded at (x, y), how many samples a selection takes there, and where inside the pixel
// sample s of every pixel lies (the same for all, like the passes of a shifted recording).
struct World {
  int width = 0, height = 0, spp = 0;
  std::function<Rgb(int, int, int)> radiance;
  std::function<double(std::string_view layer, std::size_t c, int, int, int)> feature;
  std::function<int(int, int)> count;
  std::vector<FilmPosition> film;
};

// Coloured noise over a gradient, an edge and a disc; multiples of 2^-10 below 8, so that a factor
// or a summand of few digits is exact in float.
inline World any_world(int width, int height, int spp, std::uint64_t seed) {
  World world{width, height, spp, {}, {}, {}, {}};
  world.radiance = [=](int x, int y, int s) {
    double mean = 0.4 + 0.3 * x / width;
    if (2 * x + y > width + height / 2) mean += 0.6;
    const double dx = x - 0.3 * width, dy = y - 0.7 * height;
    if (dx * dx + dy * dy < 0.03 * width * height) mean = 1.5;
    Rgb value{};
    for (std::size_t c = 0; c < 3; ++c) {
      const double u = unit_double(mix(seed, x, y, s, c));
      const double v = mean * (1.0 - 0.2 * static_cast<double>(c)) * (0.4 + 1.2 * u);
      value[c] = static_cast<float>(std::round(v * 1024.0) / 1024.0);
    }
    return value;
  };
  world.feature = [=](std::string_view layer, std::size_t c, int x, int y, int s) {
    return made_feature(layer, c, x, y, s, width);
  };
  world.count = [=](int x, int y) { return 2 + static_cast<int>(mix(seed, x, y, 99) % (spp - 1)); };
  for (int s = 0; s < spp; ++s)
    world.film.push_back(
        {static_cast<float>(uniform(seed, s, 1)), static_cast<float>(uniform(seed, s, 2))});
  return world;
}

// One coloured sample far above the others.
inline World with_firefly(const World& w) {
  World changed = w;
  changed.radiance = [=](int x, int y, int s) {
    return x == 5 && y == 4 && s == 0 ? Rgb{60.0f, 20.0f, 30.0f} : w.radiance(x, y, s);
  };
  return changed;
}

// Everything that lies at pixels, with what `from(x, y)` says lies at (x, y) now.
template <class From>
World with_pixels(const World& w, From from) {
  World m = w;
  m.radiance = [=](int x, int y, int s) {
    const auto [px, py] = from(x, y);
    return w.radiance(px, py, s);
  };
  m.feature = [=](std::string_view layer, std::size_t c, int x, int y, int s) {
    const auto [px, py] = from(x, y);
    return w.feature(layer, c, px, py, s);
  };
  m.count = [=](int x, int y) {
    const auto [px, py] = from(x, y);
    return w.count(px, py);
  };
  return m;
}

inline World mirrored(const World& w) {
  World m = with_pixels(w, [=](int x, int y) { return std::pair{w.width - 1 - x, y}; });
  for (FilmPosition& f : m.film)
    f.x = std::nextafter(1.0f - f.x, 0.0f);
  return m;
}

inline World transposed(const World& w) {
  World m = with_pixels(w, [](int x, int y) { return std::pair{y, x}; });
  std::swap(m.width, m.height);
  for (FilmPosition& f : m.film)
    std::swap(f.x, f.y);
  return m;
}

// By `dx`, `dy` pixels on a torus.
inline World shifted(const World& w, int dx, int dy) {
  const auto from = [](int at, int by, int n) { return ((at - by) % n + n) % n; };
  return with_pixels(
      w, [=](int x, int y) { return std::pair{from(x, dx, w.width), from(y, dy, w.height)}; });
}

inline World scaled(const World& w, float factor) {
  World m = w;
  m.radiance = [=](int x, int y, int s) {
    Rgb value = w.radiance(x, y, s);
    for (float& v : value)
      v *= factor;
    return value;
  };
  return m;
}

inline World lifted(const World& w, float summand) {
  World m = w;
  m.radiance = [=](int x, int y, int s) {
    Rgb value = w.radiance(x, y, s);
    for (float& v : value)
      v += summand;
    return value;
  };
  return m;
}

inline World with_channels(const World& w, const std::array<std::size_t, 3>& order) {
  World m = w;
  m.radiance = [=](int x, int y, int s) {
    const Rgb value = w.radiance(x, y, s);
    return Rgb{value[order[0]], value[order[1]], value[order[2]]};
  };
  return m;
}

// The taken samples of each pixel in another order; the film positions go with them only where
// every pixel takes the same samples, so such worlds have none.
inline World with_prefix_turned(const World& w, int by) {
  World m = w;
  m.radiance = [=](int x, int y, int s) {
    const int n = w.count(x, y);
    return w.radiance(x, y, s < n ? (s + by) % n : s);
  };
  m.feature = [=](std::string_view layer, std::size_t c, int x, int y, int s) {
    const int n = w.count(x, y);
    return w.feature(layer, c, x, y, s < n ? (s + by) % n : s);
  };
  return m;
}

inline SamplePool record(const World& w) {
  auto recording = RecordedSamples::from_memory("world", w.width, w.height, w.spp, [&] {
    std::vector<float> values;
    values.reserve(static_cast<std::size_t>(3) * w.width * w.height * w.spp);
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = 0; y < w.height; ++y) {
        for (int x = 0; x < w.width; ++x) {
          for (int s = 0; s < w.spp; ++s)
            values.push_back(w.radiance(x, y, s)[c]);
        }
      }
    }
    return values;
  }());
  SPOOL_CHECK(recording.has_value());
  if (!w.film.empty()) recording->set_pass_film(w.film);
  add_features(*recording, w.feature);
  return pool_of(std::make_shared<const RecordedSamples>(std::move(*recording)));
}

inline CountImage counts_of(const World& w) {
  CountImage n(w.width, w.height);
  for (int y = 0; y < w.height; ++y) {
    for (int x = 0; x < w.width; ++x)
      n(x, y) = w.count(x, y);
  }
  return n;
}

inline Selection select(const World& w, const SamplePool& pool) {
  return {prefix_statistics(pool, counts_of(w)), {}};
}

}  // namespace spool::test
