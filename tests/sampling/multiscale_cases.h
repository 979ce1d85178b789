// Options and pools shared by the tests of the multiscale sampler.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "lib/core/random.h"
#include "lib/sampling/multiscale/multiscale.h"
#include "tests/support/memory_pool.h"

namespace spool::test {

// Noise whose strength varies over the picture; continuous, so that priorities do not tie.
inline Rgb varied_noise(int width, int x, int y, int s) {
  const double scale = x < width / 2 ? 0.1 : 1.0 + std::sin(0.7 * y);
  const auto value = [&](int c) {
    const double u = unit_double(mix(5, x, y, s, c));
    return static_cast<float>(0.4 + 0.02 * x + scale * u * u);
  };
  return {value(0), value(1), value(2)};
}

inline SamplePool noisy_pool(int width, int height, int spp) {
  return memory_pool(width, height, spp,
                     [=](int x, int y, int s) { return varied_noise(width, x, y, s); });
}

inline MultiscaleOptions multiscale_options(const std::string& preset, const OptionValues& set) {
  const auto& presets = multiscale_presets();
  const auto base = std::ranges::find(presets, preset.empty() ? presets.front().first : preset,
                                      [](const auto& named) { return named.first; });
  SPOOL_CHECK(base != presets.end());
  const auto options = with_options(multiscale_option_table(), base->second, set);
  if (!options) {
    ADD_FAILURE() << options.error().message;
    return {};
  }
  return *options;
}

inline SamplingResult run_multiscale(const SamplePool& pool, long long budget,
                                     const MultiscaleOptions& options,
                                     const SamplingContext& context = {}) {
  auto result = sample_multiscale(pool, budget, options, context);
  if (!result) {
    ADD_FAILURE() << result.error().message;
    return {};
  }
  return std::move(*result);
}

}  // namespace spool::test
