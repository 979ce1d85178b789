// The options of the variance of the mean, for the table of any method that holds them.
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

template <class Options>
Option<Options> nu0_option(double Options::* member) {
  return number_option("nu0", member, 0.0, 1e3,
                       "weight of the neighbourhood in a pooled variance, in samples");
}

}  // namespace spool
