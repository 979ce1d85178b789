// The methods that a command may name: those of the library, and those made elsewhere.
//
//   counts:FILE.exr   sampler: an image of counts made elsewhere
//   image:FILE.exr    filter: an image made elsewhere
//   exec:COMMAND      either: a command that answers files with files
//   python:NAME       either: a function of a Python program that holds this library
//                     (called_methods.h)
//
// A command of a sampler is called once a round with two arguments: the statistics so far as an EXR
// (statistics_file.h), and where to write an EXR of how many more samples each piece is to get. Its
// environment holds SPOOL_ROUND, SPOOL_ROUNDS, SPOOL_LEFT, SPOOL_SHARE and SPOOL_SEED
// (asked_counts.h). A command of a filter is called with the statistics and where to write the
// image: R, G, B of the recording's size.
#pragma once

#include <string_view>
#include <vector>

#include "lib/filters/filters.h"
#include "lib/sampling/samplers.h"

namespace spool::tools {

const SamplerList& known_samplers();
const FilterList& known_filters();

// `method`, and those that it names: the parts of an ensemble, the filter in a sampler's loop.
std::vector<MethodChoice> with_inner_methods(const MethodChoice& method);

// Runs a command of a user, itself or inside.
bool is_foreign_code(const MethodChoice& method);
// Code of others, which may not like to be run several times at once.
bool runs_alone(const MethodChoice& method);

// What stands beside the name of a method that is re-implemented by description, and what it means.
inline constexpr const char* kByDescriptionMark = " [R]";
inline constexpr const char* kByDescription =
    "[R]: re-implementation by description, not from the primary text";
template <class Function>
bool is_by_description(const MethodList<Function>& list, std::string_view name) {
  const Method<Function>* method = find_method(list, name);
  return method != nullptr && method->source == Source::kDescriptions;
}

}  // namespace spool::tools
