// Builds the list entry of a reconstructor from its options, their table and its function.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/filters/reconstructor.h"

namespace spool {

// A method as its own file declares it: a function of the selection and plain options.
template <class Options>
struct ReconstructorMethod {
  std::string name;
  std::string summary;
  bool by_description = false;
  OptionTable<Options> table;
  std::vector<std::pair<std::string, Options>> presets;  // the first is the default
  Result<Reconstruction> (*run)(const Selection&, const SamplePool&, const ReconstructionContext&,
                                const Options&) = nullptr;
};

template <class Options>
ReconstructorEntry reconstructor_entry(ReconstructorMethod<Options> method) {
  ReconstructorEntry entry;
  entry.name = method.name;
  entry.summary = method.summary;
  entry.by_description = method.by_description;
  for (const auto& [name, options] : method.presets) {
    if (!name.empty()) entry.presets.push_back(name);
  }
  const auto options_of = [method](std::string_view preset) -> Result<Options> {
    if (preset.empty()) return method.presets.front().second;
    std::vector<std::string> names;
    for (const auto& [name, options] : method.presets) {
      if (name == preset && !name.empty()) return options;
      names.push_back(name);
    }
    const std::string near = nearest_name(preset, names);
    return fail(ErrorCode::kUsage, "filter {}: unknown preset '{}'{}", method.name, preset,
                near.empty() ? std::string() : fmt::format(": did you mean '{}'?", near));
  };
  entry.describe = [method, options_of](std::string_view preset) {
    const auto options = options_of(preset);
    return describe_options(method.table,
                            options.has_value() ? *options : method.presets.front().second);
  };
  entry.make = [method, options_of](std::string_view preset,
                                    const OptionValues& set) -> Result<ReconstructorFunction> {
    SPOOL_ASSIGN(const Options start, options_of(preset));
    auto options = with_options(method.table, start, set);
    if (!options.has_value()) {
      return fail(options.error().code, "filter {}: {}", method.name, options.error().message);
    }
    return ReconstructorFunction(
        [run = method.run, chosen = *options](const Selection& selection, const SamplePool& pool,
                                              const ReconstructionContext& context) {
          return run(selection, pool, context, chosen);
        });
  };
  return entry;
}

}  // namespace spool
