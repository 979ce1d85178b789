// Names of methods with their presets and options; --preset and --set for one method or several.
//
// How a method is written: lib/methods/method_text.h; those made elsewhere: external_methods.h.
//
// A setting is PART.OPTION=VALUE. PART is `sampler`, `filter`, `pool` or `metrics`, or the name of
// one method ("multiscale.alpha=0.3"). With several methods, `sampler.` and `filter.` reach those
// that have the option, and at least one must.
#pragma once

#include <string>
#include <vector>

#include "lib/core/error.h"
#include "lib/filters/filter.h"
#include "lib/methods/method_list.h"
#include "lib/metrics/error_metrics.h"
#include "lib/pool/sanitise.h"
#include "lib/sampling/sampler.h"

namespace spool::tools {

struct MethodOptions {
  std::string preset;                 // empty: each method's default
  std::vector<std::string> settings;  // "PART.OPTION=VALUE"
};

template <class Function>
struct ChosenMethod {
  MethodChoice choice;
  const Method<Function>* method;  // of the list of known ones
  Ready<Function> ready;
};

template <class Function>
std::vector<MethodChoice> choices_of(const std::vector<ChosenMethod<Function>>& chosen) {
  std::vector<MethodChoice> choices;
  choices.reserve(chosen.size());
  for (const ChosenMethod<Function>& method : chosen)
    choices.push_back(method.choice);
  return choices;
}

// Everything that the settings of one command name. Errors are kUsage and name the nearest
// known word. A preset must be known to at least one of the methods; the others keep their default.
struct Methods {
  std::vector<ChosenMethod<SamplerFunction>> samplers;
  std::vector<ChosenMethod<FilterFunction>> filters;
  SanitiseRules rules;
  MetricOptions metrics;
};

Result<Methods> choose_methods(const std::vector<std::string>& sampler_names,
                               const std::vector<std::string>& filter_names,
                               const MethodOptions& options);
// A sampler and the filter in its loop: the one called `filter_name`; where that is empty, the one
// that the sampler names, if it names one. A name for a sampler without a loop is an error.
Result<Methods> choose_with_loop_filter(const std::string& sampler_name,
                                        const std::string& filter_name,
                                        const MethodOptions& options);

}  // namespace spool::tools
