// The names of docs/method.md under which reconstructors hand over their intermediate images.
#include "lib/filters/reconstructor.h"

namespace spool {

std::vector<ViewDescription> reconstructor_views(std::string_view name) {
  if (name == "directional") {
    return {
        {"f.k", "coarse images (eqs 1-3)"},
        {"d.k", "detail images (eq 4)"},
        {"S.k", "variance (or contrast) of the mean over regions of level k (eq 9)"},
        {"q.k", "value of regions of level k (eq 9)"},
        {"w.k", "weight of the squared difference (eq 9)"},
        {"T.k", "criterion of the size; positive stops (eq 9)"},
        {"stop.k", "1 where the size stops at level k, after the vote"},
        {"base_variance", "variance of the base image, analysis signal"},
        {"level", "chosen size: 2^level pieces"},
        {"band_energy.k.i", "energy of direction i at level k"},
        {"delta.i", "width of the filter along direction i, pieces (eq 12)"},
        {"dominant_direction", "direction of the widest extent, degrees; NaN where round"},
    };
  }
  if (name == "greedy_selection") {
    return {{"stop.s", "1 where scale s stops, after the vote"},
            {"level", "chosen scale; 0: the base image"}};
  }
  if (name == "cross_bilateral") return {{"risk.s", "smoothed estimate of the risk of scale s"}};
  return {};
}

}  // namespace spool
