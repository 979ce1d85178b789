// The methods of a plan, read from its text.
#pragma once

#include "lib/experiment/plan.h"
#include "lib/experiment/toml_reader.h"

namespace spool {

// The methods that a plan may name.
struct PlanVocabulary {
  const MethodList<SamplerFunction>& samplers;
  const MethodList<FilterFunction>& filters;
  bool has_results = false;  // they are only read: what methods run may be missing
};

// Samplers and filters by name ("samplers"), then in full ([[sampler]]) with sweeps written out.
// Errors kUsage.
Result<void> read_methods(const TomlReader& toml, const toml::table& root,
                          const PlanVocabulary& vocabulary, Plan& plan);

}  // namespace spool
