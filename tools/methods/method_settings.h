// Names of methods with their presets and options; --preset and --set for one method or several.
//
// A method is written NAME, NAME:PRESET, NAME{a=1,b=2} or NAME:PRESET{a=1,b=2}, the label that it
// has in every table; a method made elsewhere is written NAME:ARGUMENT (external_methods.h).
//
// A setting is PART.OPTION=VALUE. PART is `sampler`, `filter`, `pool` or `metrics`, or the name of
// one method
// ("multiscale.alpha=0.3"). With several methods, `sampler.` and `filter.` reach those that have
// the option, and at least one must.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lib/core/error.h"
#include "lib/experiment/experiment.h"
#include "lib/pool/sanitise.h"

namespace spool::tools {

struct MethodOptions {
  std::string preset;                 // empty: each method's default
  std::vector<std::string> settings;  // "PART.OPTION=VALUE"
};

// Everything that the settings of one command speak of; each method can be made. Errors are kUsage
// and name the nearest known word. A preset must be known to at least one of the methods; the
// others keep their default.
struct Methods {
  std::vector<MethodChoice> samplers;
  std::vector<MethodChoice> filters;
  SanitiseRules rules;
  MetricOptions metrics;
};

// The parts of "a,b:paper,c{x=1,y=2}": commas in braces and in quotes do not part.
std::vector<std::string> split_methods(std::string_view text);

Result<Methods> choose_methods(const std::vector<std::string>& sampler_names,
                               const std::vector<std::string>& filter_names,
                               const MethodOptions& options);

Result<SamplerFunction> make_sampler(const MethodChoice& choice);
Result<ReconstructorFunction> make_filter(const MethodChoice& choice);

}  // namespace spool::tools
