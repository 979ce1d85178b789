// The pair of methods that every other is compared with: the same number of samples everywhere, and
// their mean.
#pragma once

#include <string_view>

#include "lib/methods/method_text.h"

namespace spool {

inline constexpr std::string_view kBaselineSampler = "uniform";
inline constexpr std::string_view kBaselineFilter = "box";

inline bool is_baseline(const MethodChoice& sampler, const MethodChoice& filter) {
  return sampler.name == kBaselineSampler && filter.name == kBaselineFilter;
}

}  // namespace spool
