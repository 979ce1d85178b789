// Every sampler and every filter of the lists, with every preset, ready to run in a test.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "lib/filters/filters.h"
#include "lib/sampling/samplers.h"

namespace spool::test {

template <class Function>
struct NamedMethod {
  std::string name;    // of the list
  std::string preset;  // "" where the method has none
  Ready<Function> run;
  std::string label() const { return preset.empty() ? name : name + " " + preset; }
};

// Radii of patch filters that make a method fast on small images without changing what it does.
template <class Function>
OptionValues fast_options(const Method<Function>& entry, const std::string& preset) {
  OptionValues set;
  const auto options = entry.describe(preset);
  const auto has = [&](std::string_view name) {
    return std::any_of(options.begin(), options.end(),
                       [&](const OptionDescription& o) { return o.name == name; });
  };
  if (has("window") && has("patch")) set = {{"window", "3"}, {"patch", "1"}};
  return set;
}

template <class Function>
std::vector<NamedMethod<Function>> every_method(const MethodList<Function>& entries, bool fast) {
  std::vector<NamedMethod<Function>> methods;
  for (const Method<Function>& entry : entries) {
    const std::vector<std::string> presets =
        entry.presets.empty() ? std::vector<std::string>{""} : entry.presets;
    for (const std::string& preset : presets) {
      auto made = entry.make(preset, fast ? fast_options(entry, preset) : OptionValues{});
      SPOOL_CHECK(made.has_value());
      methods.push_back({entry.name, preset, std::move(*made)});
    }
  }
  return methods;
}

inline std::vector<NamedMethod<SamplerFunction>> every_sampler(bool fast = true) {
  return every_method(samplers(), fast);
}

inline std::vector<NamedMethod<FilterFunction>> every_filter(bool fast = true) {
  return every_method(filters(), fast);
}

// Hands the pixel means to samplers that filter in their loop.
inline SamplingContext sampling_context(std::uint64_t seed = 11) {
  SamplingContext context;
  context.seed = seed;
  context.filter = [](const Selection& selection, const SamplePool&) -> Result<RgbImage> {
    GuardCounts guards;
    return pixel_means(selection.statistics, guards);
  };
  return context;
}

// The mean of everything recorded, what oracles are handed.
inline Reference mean_of_everything(const SamplePool& pool) {
  CountImage all(pool.width(), pool.height());
  for (int y = 0; y < all.height(); ++y) {
    for (int x = 0; x < all.width(); ++x)
      all(x, y) = pool.capacity(x, y);
  }
  GuardCounts guards;
  return {pixel_means(prefix_statistics(pool, all), guards), std::nullopt};
}

// `count` samples of every piece, or what it has.
inline Selection select_uniform(const SamplePool& pool, int count) {
  CountImage n(pool.width(), pool.height());
  for (int y = 0; y < n.height(); ++y) {
    for (int x = 0; x < n.width(); ++x)
      n(x, y) = std::min(count, pool.capacity(x, y));
  }
  return {prefix_statistics(pool, n), {}};
}

}  // namespace spool::test
