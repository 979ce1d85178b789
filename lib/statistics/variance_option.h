// The option of the variance of the mean, for the table of any method that holds it.
#pragma once

#include "lib/core/option_table.h"
#include "lib/statistics/variance_of_mean.h"

namespace spool {

template <class Options>
Option<Options> var_mode_option(VarianceMode Options::* member) {
  return choice_option<Options, VarianceMode>(
      "var_mode", member,
      {{"auto", VarianceMode::kAuto},
       {"raw", VarianceMode::kRaw},
       {"pooled", VarianceMode::kPooled}},
      "variance of a piece's mean: auto pools below 4 samples");
}

}  // namespace spool
