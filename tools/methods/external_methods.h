// The methods that a command may name: those of the library, and those made elsewhere.
//
//   counts:FILE.exr   sampler: an image of counts that somebody made
//   image:FILE.exr    filter: an image that somebody made
//   exec:COMMAND      either: a command that answers files with files
//
// A command of a sampler is called once a round with two arguments: the statistics so far as an EXR
// (statistics_file.h), and where to write an EXR of how many more samples each piece is to get. Its
// environment holds SPOOL_ROUND, SPOOL_ROUNDS, SPOOL_LEFT, SPOOL_SHARE and SPOOL_SEED
// (asked_counts.h). A command of a filter is called with the statistics and where to write the
// image: R, G, B of the recording's size.
#pragma once

#include <string_view>
#include <vector>

#include "lib/filters/reconstructor.h"
#include "lib/sampling/sampler.h"

namespace spool::tools {

const std::vector<SamplerEntry>& known_samplers();
const std::vector<ReconstructorEntry>& known_filters();

// What stands beside the name of a method that is re-implemented by description, and what it means.
inline constexpr const char* kByDescriptionMark = " [R]";
inline constexpr const char* kByDescription =
    "[R]: re-implementation by description, not from the primary text";
bool sampler_by_description(std::string_view name);
bool filter_by_description(std::string_view name);

}  // namespace spool::tools
