// The combinations of options that the tests of the pyramid walk through.
#pragma once

#include <string>
#include <vector>

#include "lib/pyramid/laplacian_pyramid.h"

namespace spool {

inline constexpr Extension kExtensions[] = {Extension::kSymmetric, Extension::kClamp,
                                            Extension::kPeriodic, Extension::kWhole};

// Every filter, role and detail; the extension is the caller's.
inline std::vector<PyramidOptions> all_pyramid_options(Extension extension, int levels = 4) {
  std::vector<PyramidOptions> cases;
  for (const auto filter :
       {WaveletFilter::kHaar, WaveletFilter::k53, WaveletFilter::k97, WaveletFilter::kDb3}) {
    for (const auto roles : {FilterRoles::kLongAnalysis, FilterRoles::kSwapped}) {
      for (const auto detail : {LaplacianDetail::kCycleSpun, LaplacianDetail::kPhase00}) {
        cases.push_back({filter, roles, detail, levels, extension});
      }
    }
  }
  return cases;
}

inline std::string describe(const PyramidOptions& options) {
  std::string text;
  for (const auto& [name, value] : option_values(pyramid_option_table(), options)) {
    text += name + "=" + value + " ";
  }
  return text + "extension=" + std::to_string(static_cast<int>(options.extension));
}

}  // namespace spool
