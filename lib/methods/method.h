// A method - a sampler, a filter - as one value: its name, where it comes from, its presets and
// options, the images it can show, what it needs, and how it is made.
//
// The file of a method ends with its value; lib/sampling/samplers.cpp and lib/filters/filters.cpp
// are the only lists. What a method is stands here.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/core/error.h"
#include "lib/core/option_table.h"
#include "lib/core/view.h"
#include "lib/core/working_memory.h"
#include "lib/methods/reading.h"

namespace spool {

enum class Source {
  kPrimaryText,   // the paper itself
  kDescriptions,  // what others say of it: "[R]" in every list
};

enum class Use { kNone, kWhenRecorded, kRequired };

// What a method asks for beyond the radiance of its samples.
struct Needs {
  Use features = Use::kNone;        // albedo, normal or depth of each sample
  Use film_positions = Use::kNone;  // where in its pixel each sample fell
  bool reference = false;           // an oracle: it knows the answer
  bool filter_in_loop = false;      // a sampler that asks for the image of a filter
  std::string loop_filter = {};     // that filter's name; empty: the filter of the image
  bool signal = true;               // false: no analysis signal but the mean that exposes it
  bool variance = true;  // false: means alone where the image's variance is not asked for
  bool pool = true;      // false: a filter that reads the selection's statistics alone
  bool samples = true;   // false: an image made elsewhere, the same for any samples
  friend bool operator==(const Needs&, const Needs&) = default;
};

// Of methods of other people, and of those that were not measured.
inline constexpr WorkingMemory kUnmeasuredMemory = {400, 5e6};
// CPU seconds of a megapixel with 8 samples a pixel and default options (docs/speed.md). Only the
// order of work and its shares depend on it, never a result.
inline constexpr double kUnmeasuredCost = 5.0;

// A method with its options chosen. It is called as its function is.
template <class Function>
struct Ready {
  Function run;
  Needs needs;
  WorkingMemory memory = kUnmeasuredMemory;           // its own; a filter in its loop takes more
  std::optional<WorkingMemory> memory_of_means = {};  // where it gets means alone (Needs::variance)
  // Error kUsage where a library of others that it runs is missing; empty: it runs none.
  std::function<Result<void>()> installed = nullptr;

  template <class... Arguments>
  auto operator()(Arguments&&... arguments) const {
    return run(std::forward<Arguments>(arguments)...);
  }
};

template <class Function>
struct Method {
  std::string name;
  std::string summary;
  Source source = Source::kPrimaryText;
  std::vector<std::string> presets;  // the first is the default; empty: no presets
  std::vector<Reading> readings;     // what may stand behind a preset, each after a '+'
  std::string argument;              // "FILE.exr": what NAME:... takes where others have a preset
  std::vector<ViewDescription> views;
  Needs needs;              // with the default options
  bool footprints = false;  // a filter that can say its weights (footprint.h)
  double cost = kUnmeasuredCost;
  std::function<std::vector<OptionDescription>(std::string_view preset)> describe;
  // An empty preset is the default. Errors kUsage: an unknown preset or option, a wrong value.
  std::function<Result<Ready<Function>>(std::string_view preset, const OptionValues& set)> make;
};

// `method` with its options chosen, ready to run; `kind` is for errors.
template <class Function>
Result<Ready<Function>> make_ready(std::string_view kind, const Method<Function>& method,
                                   std::string_view preset, const OptionValues& set) {
  Result<Ready<Function>> ready = method.make(preset, set);
  if (ready || ready.error().code != ErrorCode::kUsage) return ready;
  return fail(ErrorCode::kUsage, "{} {}: {}", kind, method.name, ready.error().message);
}

// The presets by name, the default first. One preset named "" means that the method has none.
template <class Options>
using Presets = std::vector<std::pair<std::string, Options>>;

// The type behind a method's function: the same arguments, with its options before the context.
template <class Function, class Options>
struct WithOptions;

template <class R, class A, class B, class Context, class Options>
struct WithOptions<std::function<R(A, B, Context)>, Options> {
  using Type = R (*)(A, B, const Options&, Context);

  static std::function<R(A, B, Context)> bind(Type run, Options options) {
    return [run, options = std::move(options)](A a, B b, Context context) {
      return run(a, b, options, context);
    };
  }
};

// What the file of a method says about it.
template <class Function, class Options>
struct MethodParts {
  std::string name;
  std::string summary;
  Source source = Source::kPrimaryText;
  OptionTable<Options> options = {};
  Presets<Options> presets = {{"", {}}};
  std::vector<Reading> readings = {};
  std::vector<ViewDescription> views = {};
  std::function<Needs(const Options&)> needs = nullptr;  // none: nothing but samples
  WorkingMemory memory = kUnmeasuredMemory;
  std::optional<WorkingMemory> memory_of_means = {};
  double cost = kUnmeasuredCost;
  bool footprints = false;
  typename WithOptions<Function, Options>::Type run = nullptr;

  // "PRESET", "PRESET+READING", "+READING".
  Result<Options> chosen(std::string_view wanted) const {
    SPOOL_ASSIGN(Options start, preset(wanted.substr(0, wanted.find('+'))));
    SPOOL_ASSIGN(const OptionValues values, reading_values(readings, wanted));
    return with_options(options, std::move(start), values);
  }
  Result<Options> preset(std::string_view wanted) const {
    if (wanted.empty()) return presets.front().second;
    std::vector<std::string> names;
    for (const auto& [known, values] : presets) {
      if (known == wanted) return values;
      if (!known.empty()) names.push_back(known);
    }
    return fail(ErrorCode::kUsage, "{}",
                unknown_name("preset", wanted, names, names.empty() ? ": it has none" : ""));
  }
  Needs needs_of(const Options& values) const { return needs ? needs(values) : Needs{}; }
};

template <class Function, class Options>
Method<Function> make_value(MethodParts<Function, Options> parts) {
  Method<Function> method;
  method.name = parts.name;
  method.summary = parts.summary;
  method.source = parts.source;
  method.readings = parts.readings;
  method.views = parts.views;
  method.needs = parts.needs_of(parts.presets.front().second);
  method.footprints = parts.footprints;
  method.cost = parts.cost;
  for (const auto& preset : parts.presets) {
    if (!preset.first.empty()) method.presets.push_back(preset.first);
  }
  method.describe = [parts](std::string_view preset) {
    return describe_options(parts.options,
                            parts.chosen(preset).value_or(parts.presets.front().second));
  };
  method.make = [parts](std::string_view preset,
                        const OptionValues& set) -> Result<Ready<Function>> {
    SPOOL_ASSIGN(const Options start, parts.chosen(preset));
    SPOOL_ASSIGN(const Options options, with_options(parts.options, start, set));
    return Ready<Function>{WithOptions<Function, Options>::bind(parts.run, options),
                           parts.needs_of(options), parts.memory, parts.memory_of_means};
  };
  return method;
}

}  // namespace spool
