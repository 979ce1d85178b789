#include "lib/filters/filters.h"

#include <utility>

#include "lib/filters/box.h"
#include "lib/filters/clamped.h"
#include "lib/filters/cross_bilateral.h"
#include "lib/filters/directional/directional.h"
#include "lib/filters/filter_stage.h"
#include "lib/filters/gaussian.h"
#include "lib/filters/greedy_selection.h"
#include "lib/filters/multistage.h"
#include "lib/filters/nl_means.h"
#include "lib/filters/oracle_scale.h"
#include "lib/filters/twin_guides/twin_guides.h"
#include "lib/filters/wavelet_shrinkage.h"
#include "lib/filters/welch/stater.h"
#include "lib/filters/welch/welch.h"

namespace spool {

const FilterList& filters() {
  static const FilterList list = [] {
    FilterList all = {"filter",
                      {box_filter(), clamped_filter(), gaussian_filter(), directional_filter(),
                       greedy_selection_filter(), nl_means_filter(), cross_bilateral_filter(),
                       multistage_filter(), wavelet_shrinkage_filter(), oracle_scale_filter(),
                       twin_guides_filter(), welch_filter(), stater_filter()}};
    for (Filter& filter : all.methods)
      filter = with_stage_options(std::move(filter));
    return all;
  }();
  return list;
}

}  // namespace spool
