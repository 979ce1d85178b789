// Builds an entry of the list of samplers from a method's options, its table and its function.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/sampling/sampler.h"

namespace spool {

enum class PrimaryText { kKnown, kByDescription };

// The presets by name, the default first. One preset named "" means that the method has none.
template <class Options>
using Presets = std::vector<std::pair<std::string, Options>>;

template <class Options>
Result<Options> find_preset(const Presets<Options>& presets, std::string_view sampler,
                            std::string_view preset) {
  if (preset.empty()) return presets.front().second;
  std::vector<std::string> names;
  for (const auto& [name, options] : presets) {
    if (name == preset) return options;
    names.push_back(name);
  }
  if (names.size() == 1 && names[0].empty()) {
    return fail(ErrorCode::kUsage, "sampler {}: has no presets, not '{}'", sampler, preset);
  }
  const std::string near = nearest_name(preset, names);
  return fail(ErrorCode::kUsage, "sampler {}: unknown preset '{}'{}", sampler, preset,
              near.empty() ? std::string() : fmt::format(": did you mean '{}'?", near));
}

template <class Options, class Sample>
SamplerEntry sampler_entry(std::string name, std::string summary, PrimaryText text,
                           Presets<Options> presets, OptionTable<Options> table, Sample sample) {
  SamplerEntry entry;
  entry.name = name;
  entry.summary = std::move(summary);
  entry.by_description = text == PrimaryText::kByDescription;
  for (const auto& preset : presets) {
    if (!preset.first.empty()) entry.presets.push_back(preset.first);
  }
  entry.describe = [=](std::string_view preset) {
    const Result<Options> options = find_preset(presets, name, preset);
    return describe_options(table, options.value_or(presets.front().second));
  };
  entry.make = [=](std::string_view preset, const OptionValues& set) -> Result<SamplerFunction> {
    SPOOL_ASSIGN(const Options base, find_preset(presets, name, preset));
    Result<Options> options = with_options(table, base, set);
    if (!options) {
      return fail(options.error().code, "sampler {}: {}", name, options.error().message);
    }
    return SamplerFunction([options = *options, sample](const SamplePool& pool, long long budget,
                                                        const SamplingContext& context) {
      return sample(pool, budget, options, context);
    });
  };
  return entry;
}

}  // namespace spool
