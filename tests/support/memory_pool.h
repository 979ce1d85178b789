// Pools in memory for tests: radiance from a function of pixel and sample.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "lib/pool/sample_pool.h"
#include "tests/support/made_features.h"

namespace spool::test {

// radiance(x, y, s) -> Rgb, any value.
template <class Radiance>
std::shared_ptr<const RecordedSamples> memory_recording(int width, int height, int spp,
                                                        Radiance&& radiance,
                                                        const SanitiseRules& rules = {}) {
  std::vector<float> values(static_cast<std::size_t>(3) * width * height * spp);
  const std::size_t plane = static_cast<std::size_t>(width) * height * spp;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int s = 0; s < spp; ++s) {
        const Rgb value = radiance(x, y, s);
        const std::size_t i = (static_cast<std::size_t>(y) * width + x) * spp + s;
        for (std::size_t c = 0; c < 3; ++c)
          values[c * plane + i] = value[c];
      }
    }
  }
  auto recording =
      RecordedSamples::from_memory("memory", width, height, spp, std::move(values), rules);
  if (!recording) {
    fmt::print(stderr, "memory_recording: {}\n", recording.error().message);
    std::abort();
  }
  add_features(*recording);
  return std::make_shared<const RecordedSamples>(std::move(*recording));
}

inline SamplePool pool_of(std::shared_ptr<const RecordedSamples> recording,
                          const PoolOptions& options = {}) {
  auto pool = SamplePool::create(std::move(recording), options);
  if (!pool) {
    fmt::print(stderr, "pool_of: {}\n", pool.error().message);
    std::abort();
  }
  return std::move(*pool);
}

template <class Radiance>
SamplePool memory_pool(int width, int height, int spp, Radiance&& radiance,
                       const SanitiseRules& rules = {}) {
  return pool_of(memory_recording(width, height, spp, std::forward<Radiance>(radiance), rules));
}

inline long long total(const CountImage& n) {
  long long sum = 0;
  for (const auto count : n.pixels())
    sum += count;
  return sum;
}

}  // namespace spool::test
